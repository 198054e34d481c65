//! Files that are made from the parameters: their document, the names of C# and the types of
//! Python.
//!
//! `INCISE_UPDATE=1 cargo test -p incise-tests generated` writes them.

use incise_cut::{CutParams, CutReport};
use incise_paper::PaperParams;
use incise_params::{Field, Kind, Params, Report, Value, all_fields, short_name};
use incise_pbd_gpu::Material;
use incise_refine::HoleParams;
use incise_scene::{FrameStats, SceneParams};
use std::fmt::Write;
use std::path::Path;

/// Compares a file of the repository, or writes it.
fn compare(path: &str, expected: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    if std::env::var_os("INCISE_UPDATE").is_some() {
        std::fs::write(&file, expected).expect("a file of the repository");
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    let differs = found.lines().zip(expected.lines()).find(|(a, b)| a != b);
    assert!(
        found == expected,
        "{path} is not that of the parameters: {differs:?}; run INCISE_UPDATE=1 cargo test -p \
         incise-tests generated"
    );
}

/// Returns the fields of a struct that have a value of their own.
fn leaves(fields: &'static [Field]) -> Vec<(String, &'static Field)> {
    let all = all_fields(fields).into_iter();
    all.filter(|(_, field)| !matches!(field.kind, Kind::Struct(_)))
        .collect()
}

/// Returns the values of a kind, as a noun.
fn values(kind: &Kind, field: &Field) -> String {
    match kind {
        Kind::Number => match field.range.to_string().as_str() {
            "a finite number" => "a number".to_owned(),
            range => range.replace("finite ", ""),
        },
        Kind::Count => match field.range.to_string().as_str() {
            "a finite number" => "a whole number".to_owned(),
            range => format!("a whole number {range}").replace("a finite number ", ""),
        },
        Kind::Optional(Kind::Struct(_)) => "on or off".to_owned(),
        Kind::Optional(inner) => format!("{}, or none", values(inner, field)),
        Kind::Choice(names) => quoted(names.iter().copied()),
        Kind::Variants(variants) => {
            let alternatives = variants.iter().map(|variant| match variant.kind {
                Kind::Unit => format!("`{}`", variant.name),
                ref kind => {
                    let unit = match variant.unit {
                        "" => String::new(),
                        unit => format!(" [{unit}]"),
                    };
                    format!("`{}`: {}{unit}", variant.name, values(kind, variant))
                }
            });
            alternatives.collect::<Vec<_>>().join("; ")
        }
        kind => kind.to_string(),
    }
}

fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names
        .map(|name| format!("`{name}`"))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Returns the default of a parameter for a table.
fn default(field: &Field) -> String {
    match (field.default)() {
        Value::Map(entries) => match (field.kind.inner(), entries.as_slice()) {
            (Kind::Variants(_), [(name, value)]) => format!("`{name}`: {value}"),
            _ => "on".to_owned(),
        },
        Value::None if matches!(field.kind, Kind::Optional(Kind::Struct(_))) => "off".to_owned(),
        Value::Count(count) if count == usize::MAX as u64 => "no limit".to_owned(),
        Value::Text(name) => format!("`{name}`"),
        value => value.to_string(),
    }
}

/// Appends the table of a struct.
fn table<P: Params>(out: &mut String) {
    out.push_str("| name | values | default | unit | meaning |\n|---|---|---|---|---|\n");
    for (name, field) in leaves(P::FIELDS) {
        let (values, default) = (values(&field.kind, field), default(field));
        let (unit, meaning) = (
            field.unit,
            field.text().replace("\n\n", " ").replace('\n', " "),
        );
        writeln!(
            out,
            "| `{name}` | {values} | {default} | {unit} | {meaning} |"
        )
        .expect("a string");
    }
}

/// Appends the table of a report.
fn report_table<R: Report>(out: &mut String) {
    out.push_str("| name | value | unit | meaning |\n|---|---|---|---|\n");
    for (name, field) in leaves(R::FIELDS) {
        let text = field.text().replace("\n\n", " ").replace('\n', " ");
        let (kind, unit) = (&field.kind, field.unit);
        writeln!(out, "| `{name}` | {kind} | {unit} | {text} |").expect("a string");
    }
}

const REPORTS: &str = "
# Reports

| where | how |
|---|---|
| Rust | fields of the structs, or `Report::get(\"seconds.detection\")` |
| command line | `incise cut --json`: the object `cut` |
| Python | `result.report[\"hits\"]`, `scene.step().bvh_refits`, `.detection` |
| JavaScript | `mesh.cut(..).hits`, `scene.stats.seconds.solver` |
| C | `incise_cut_result_statistic(result, \"hits\", &x)`, `incise_scene_statistic(..)` |
| C# | `result.Statistic(CutStatistic.Hits)`, `scene.Statistic(FrameStatistic.BvhRefits)` |

";

const INTRODUCTION: &str = "\
# Parameters

Made from the declarations in Rust by `INCISE_UPDATE=1 cargo test -p incise-tests generated`.

A name may leave out leading parts, and have underscores or dashes in place of dots:
`solver.substep` is also `substep`, and `cut.refine.level` is `refine_level`. A parameter that
is on or off is set by true and false, by `NAME.enabled`, or by its own parameters, which switch it
on. What is switched off stays off beside its own parameters. `none` switches off a value that is
optional; in files it is the text `\"none\"`. Two names of one parameter are refused. Lists are
three numbers. Options of the command line have the shortest name only.

| where | how |
|---|---|
| Rust | fields of the structs, or `Params::set(\"solver.substep\", ..)` |
| scene files | keys: `substep = 0.002`, `[solver]` with `substep = 0.002`, `[contacts]` |
| command line | `--substep 0.002 --contacts-thickness 0.2`; also `cut`, `render` and `fill` |
| Python | `Scene(substep=0.002, contacts={\"thickness\": 0.2})`, `mesh.cut(normal, snap=0.2)` |
| JavaScript | `scene.set({ substep: 0.002, contacts: { thickness: 0.2 } })` |
| C | `incise_scene_set_number(scene, \"solver.substep\", 0.002)`, `incise_body_set(..)` |
| C# | `scene.Set(SceneParameter.SolverSubstep, 0.002)` |

";

#[test]
fn the_document_lists_all_parameters() {
    let mut out = INTRODUCTION.to_owned();
    out.push_str(
        "## Scenes: `SceneParams`\n\nThose of `cut` are also those of a cut of a mesh.\n\n",
    );
    table::<SceneParams>(&mut out);
    out.push_str("\n## Materials: `Material`\n\nA preset is the start:\n");
    out.push_str(&quoted(Material::PRESETS.iter().copied()));
    out.push_str(".\nThe defaults here are those of `limp-shell`.\n\n");
    table::<Material>(&mut out);
    out.push_str("\n## Filled holes: `HoleParams`\n\n");
    table::<HoleParams>(&mut out);
    out.push_str("\n## The paper's method: `PaperParams`\n\nOf `incise-paper`, and of ");
    out.push_str("`incise cut --method paper`.\n\n");
    table::<PaperParams>(&mut out);
    out.push_str(REPORTS);
    out.push_str("## Cuts: `CutReport`\n\n");
    report_table::<CutReport>(&mut out);
    out.push_str("\n## Frames: `FrameStats`\n\n");
    report_table::<FrameStats>(&mut out);
    compare("docs/parameters.md", &out);
}

#[test]
fn c_sharp_has_the_names() {
    let mut out = String::from(
        "// Made from the parameters of the library by its test `generated`.\n\
         \nnamespace Incise\n{\n",
    );
    names(
        &mut out,
        SceneParams::FIELDS,
        "SceneParameter",
        "parameters of a scene",
    );
    names(
        &mut out,
        Material::FIELDS,
        "MaterialParameter",
        "parameters of a material",
    );
    names(
        &mut out,
        CutReport::FIELDS,
        "CutStatistic",
        "counts and times of a cut",
    );
    names(
        &mut out,
        FrameStats::FIELDS,
        "FrameStatistic",
        "counters and times of a frame",
    );
    out.push_str("}\n");
    compare("crates/ffi/unity/Runtime/ParameterNames.cs", &out);
}

/// Appends a class with the names of a struct's fields.
fn names(out: &mut String, fields: &'static [Field], class: &str, noun: &str) {
    if !out.ends_with("{\n") {
        out.push('\n');
    }
    let pascal = |name: &str| -> String {
        let words = name.split(['.', '_']);
        words.map(|w| w[..1].to_uppercase() + &w[1..]).collect()
    };
    writeln!(
        out,
        "    /// <summary>Names of the {noun}.</summary>\n    public static class \
         {class}\n    {{"
    )
    .expect("a string");
    for (name, field) in leaves(fields) {
        let summary = field.summary().replace('&', "&amp;").replace('<', "&lt;");
        writeln!(out, "        /// <summary>{summary}</summary>").expect("a string");
        let constant = pascal(&name);
        writeln!(out, "        public const string {constant} = \"{name}\";").expect("a string");
    }
    out.push_str("    }\n");
}

#[test]
fn python_has_the_types() {
    let path = "crates/python/python/incise/_incise.pyi";
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    let stub = std::fs::read_to_string(file).expect("a file of the repository");
    let (begin, end) = ("# Made from the parameters by", "# End of that part.\n");
    let (before, rest) = stub.split_once(begin).expect("the begin of the part");
    let (_, after) = rest.split_once(end).expect("the end of the part");
    let mut out =
        format!("{before}{begin} `INCISE_UPDATE=1 cargo test -p incise-tests generated`.\n");
    types::<CutParams>(&mut out, "CutOptions", &[]);
    types::<SceneParams>(&mut out, "SceneOptions", &["undo_limit: int"]);
    types::<Material>(&mut out, "MaterialKeys", &[]);
    types::<HoleParams>(&mut out, "FillOptions", &[]);
    properties::<FrameStats>(&mut out, "FrameStats", &["cutting"]);
    out.push_str(end);
    out.push_str(after);
    compare(path, &out);
}

/// Appends a dictionary with the short names of a struct's parameters.
fn types<P: Params>(out: &mut String, class: &str, more: &[&str]) {
    writeln!(out, "class {class}(TypedDict, total=False):").expect("a string");
    for (name, field) in leaves(P::FIELDS) {
        let name = short_name(P::FIELDS, &name).replace('.', "_");
        // `None` is the default of any parameter.
        writeln!(
            out,
            "    {name}: Optional[{}]",
            python_type(field.kind.inner())
        )
        .expect("a string");
    }
    for line in more {
        writeln!(out, "    {line}").expect("a string");
    }
    out.push('\n');
}

/// Appends a class with the values of a report as properties, and other numbers.
fn properties<R: Report>(out: &mut String, class: &str, more: &[&str]) {
    writeln!(out, "class {class}:").expect("a string");
    let values = leaves(R::FIELDS).into_iter();
    let values = values.map(|(_, field)| (field.name, python_type(&field.kind)));
    for (name, kind) in values.chain(more.iter().map(|name| (*name, "float"))) {
        writeln!(out, "    @property\n    def {name}(self) -> {kind}: ...").expect("a string");
    }
    out.push('\n');
}

fn python_type(kind: &Kind) -> &'static str {
    match kind {
        Kind::Flag => "bool",
        Kind::Number => "float",
        Kind::Count => "int",
        Kind::List(..) => "npt.ArrayLike",
        Kind::Struct(_) => "Union[bool, Mapping[str, Any]]",
        Kind::Variants(variants) if variants.iter().any(|v| matches!(v.kind, Kind::Unit)) => {
            "Union[str, float]"
        }
        Kind::Variants(_) => "Mapping[str, float]",
        _ => "str",
    }
}
