//! The page as a whole: from shipped results, with missing parts, and from bad files.

use super::error::ReportError;
use super::sources::{self, NAMES, Rows};
use super::{Content, ReportArguments, gallery};
use clap::Parser;
use std::path::{Path, PathBuf};

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    report: ReportArguments,
}

/// Returns a file of the results in the repository.
fn shipped(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    folder.join(name)
}

const SHIPPED: [&str; 9] = [
    "xeon-2-threads/table_exact.json",
    "xeon-2-threads/accuracy/chain.csv",
    "xeon-2-threads/cut_exact.json",
    "xeon-2-threads/refine.json",
    "xeon-2-threads/step_llvmpipe.json",
    "xeon-2-threads/stability.json",
    "xeon-2-threads/skip.json",
    "epyc-2-threads/table_exact.json",
    "epyc-2-threads/stability.json",
];

fn content(files: &[PathBuf]) -> Content {
    let sources = files.iter().map(|path| sources::read(path).unwrap());
    Content {
        sources: sources.collect(),
        ..Content::default()
    }
}

/// Asserts that a page loads nothing.
fn assert_self_contained(page: &str) {
    for word in [
        "http:", "https:", "<script", "<link", "@import", "url(", "<iframe", "{{",
    ] {
        assert!(!page.contains(word), "{word}");
    }
    for (at, _) in page.match_indices("src=") {
        assert!(
            page[at..].starts_with("src=\"data:"),
            "{}",
            &page[at..at + 40]
        );
    }
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn shipped_results_make_a_page_of_all_parts() {
    let content = content(&SHIPPED.map(shipped));
    let names: Vec<&str> = content.sources.iter().map(|s| s.bench()).collect();
    assert_eq!(names[..7], NAMES);
    assert_eq!(content.missing(), ["gallery"]);
    let page = content.page().unwrap();
    assert_self_contained(&page);
    // Rates, cuts and Figure 11 of two machines, where rows have it; one scene, cut, step.
    assert_eq!(page.matches("<svg").count(), 2 * 2 + 2 + 3);
    for text in [
        "Armadillo",
        "armadillo_30000_split.ply",
        "231.8",
        "7 of 80 invariants fail",
        "1 of 33 claims fail",
        "Figure 11",
        "the paper",
        "Intel(R) Xeon(R) Processor, 2 threads",
        "498ac7fc8fc3",
        "Missing: gallery.",
    ] {
        assert!(page.contains(text), "{text}");
    }
    for name in NAMES {
        let anchors = [
            format!("<h2 id=\"{name}\">"),
            format!("<a href=\"#{name}\">"),
        ];
        assert!(anchors.iter().all(|anchor| page.contains(anchor)), "{name}");
    }
    assert!(!page.contains("NaN") && !page.contains("null"));
    let xeon = "<h3>Intel(R) Xeon(R) Processor, 2 threads</h3>";
    assert_eq!(
        page.matches(xeon).count(),
        5,
        "accuracy's CSV names no machine"
    );
}

#[test]
fn all_shipped_files_of_benches_are_readable() {
    for machine in std::fs::read_dir(shipped("")).unwrap() {
        for file in std::fs::read_dir(machine.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            let is_other = name.contains("peers") || name.contains("tradeoff");
            let is_rows = name.ends_with(".json") && !is_other;
            if is_rows {
                sources::read(&path).unwrap();
            }
        }
    }
    for file in std::fs::read_dir(shipped("xeon-2-threads/accuracy")).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|e| e == "csv") {
            let source = sources::read(&path).unwrap();
            let Rows::Accuracy(rows) = source.rows else {
                panic!("{path:?}");
            };
            assert!(
                rows.iter().any(|row| row.total_position.is_some()),
                "{path:?}"
            );
        }
    }
}

#[test]
fn other_files_are_skipped_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let good = shipped("xeon-2-threads/skip.json");
    let picture = shipped("xeon-2-threads/stability.png");
    let peers = shipped("xeon-2-threads/peers_meshlib.json");
    let run = |files: &[&Path]| {
        let words = ["report", "-o"].map(PathBuf::from).into_iter();
        let words = words.chain([output.clone(), PathBuf::from("--take")]);
        let line = Line::parse_from(words.chain(files.iter().map(|&f| f.to_owned())));
        super::run(&line.report, &mut Vec::new())
    };
    assert!(run(&[&picture, &peers]).is_err(), "no rows at all");
    assert!(!output.join("report.html").exists());
    run(&[&picture, &good, &peers]).unwrap();
    let page = std::fs::read_to_string(output.join("report.html")).unwrap();
    assert_eq!(page.matches("Skipped: ").count(), 2, "{page}");
    assert!(page.contains("1 of 33 claims fail"));
    assert!(run(&[&good, &folder.path().join("nowhere.json")]).is_err());
}

#[test]
fn missing_benches_are_named() {
    let content = content(&[shipped("xeon-2-threads/skip.json")]);
    let missing = [
        "table",
        "accuracy",
        "cut",
        "refine",
        "step",
        "stability",
        "gallery",
    ];
    assert_eq!(content.missing(), missing);
    let page = content.page().unwrap();
    assert!(page.contains(&format!("Missing: {}.", missing.join(", "))));
    let mut content = Content::default();
    content.errors.insert("step", "no <device>".to_owned());
    let page = content.page().unwrap();
    assert!(page.contains("error: no &lt;device&gt;"), "{page}");
    assert_self_contained(&page);
}

#[test]
fn figure_11_is_drawn_where_rows_have_it() {
    let text = std::fs::read_to_string(shipped("xeon-2-threads/table_exact.json")).unwrap();
    let mut rows: serde_json::Value = serde_json::from_str(&text).unwrap();
    for row in rows.as_array_mut().unwrap() {
        row["pbd_fps_by_second"] = serde_json::json!([null, 100.0, 90.0]);
        row["pbd_cs_fps_by_second"] = serde_json::json!([80.0, 70.0, 60.0]);
        row["volume"] = true.into();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "table.json", &rows.to_string());
    let page = content(std::slice::from_ref(&path)).page().unwrap();
    assert_eq!(page.matches("<svg").count(), 4);
    assert!(page.contains("Figure 11a") && page.contains("Figure 11b"));
    assert!(page.contains("exact method on the CPU, model files, volumes"));
    // The same measurement again is folded.
    let page = content(&[path.clone(), path]).page().unwrap();
    assert_eq!(page.matches("<svg").count(), 4);
    assert_eq!(page.matches("another run").count(), 2);
}

#[test]
fn text_of_files_is_escaped() {
    let bad = "<img src=http://x onerror=alert(1)>&\"'";
    let folder = tempfile::tempdir().unwrap();
    let rows = serde_json::json!([{
        "skip": bad, "claim": bad, "at": bad, "bound": 1.0, "measured": null, "passed": false,
        "device": bad, "commit": bad,
    }]);
    let skip = write(folder.path(), "<b>.json", &rows.to_string());
    let rows = serde_json::json!([{
        "model": bad, "triangles": 10, "bodies": 1, "backend": bad, "device": bad,
        "schedule": bad, "ms_per_frame": 1.0, "refusal": bad,
    }]);
    let step = write(folder.path(), "step.json", &rows.to_string());
    let page = content(&[skip, step]).page().unwrap();
    assert!(!page.contains("<img") && !page.contains("<b>"), "{page}");
    assert!(page.contains("&lt;img src=http"), "it is there as text");
}

#[test]
fn bad_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let read = |name: &str, text: &str| {
        let error = sources::read(&write(folder, name, text)).unwrap_err();
        assert!(
            error.to_string().contains(name) && error.is_other_file(),
            "{error}"
        );
        error
    };
    for (i, text) in ["", "[{", "{\"a\": 1,}", "[1, 2", "\u{0}"]
        .into_iter()
        .enumerate()
    {
        let error = read(&format!("{i}.json"), text);
        assert!(matches!(error, ReportError::Json { .. }), "{text}: {error}");
    }
    let short = "[{\"torture\": \"x\", \"law\": 3}]";
    assert!(matches!(
        read("short.json", short),
        ReportError::Json { .. }
    ));
    for text in [
        "[]",
        "[{}]",
        "[1]",
        "3",
        "null",
        "[[]]",
        "[{\"program\": \"x\"}]",
    ] {
        let error = read("other.json", text);
        assert!(matches!(error, ReportError::NoRows { .. }), "{text}");
    }
    let names = "scene,backend,scheme,substeps,ms_per_frame,total_position,commit\n";
    for row in [
        "chain,cpu,xpbd,1,fast,,c",
        "chain,cpu",
        "chain,cpu,xpbd,1.5,2,,c",
    ] {
        let error = read("rows.csv", &format!("{names}{row}\n"));
        assert!(matches!(error, ReportError::Csv { .. }), "{row}: {error}");
    }
    for text in ["a,b\n1,2\n", names] {
        assert!(matches!(
            read("other.csv", text),
            ReportError::NoRows { .. }
        ));
    }
    let good = format!("{names}chain,cpu,xpbd,1,2.0,,abc\n");
    let good = sources::read(&write(folder, "good.csv", &good)).unwrap();
    assert!(matches!(&good.rows, Rows::Accuracy(rows) if rows.len() == 1));
    assert_eq!(good.commit, "abc");
}

#[test]
fn a_gallery_is_part_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let index = |file: &str| {
        let figure =
            serde_json::json!({"name": "fig1", "file": file, "caption": "<i>", "width": 1});
        let index = serde_json::json!({"device": "d", "panel": 64, "figures": [figure]});
        write(folder.path(), "index.json", &index.to_string());
        gallery::read(folder.path())
    };
    let png = b"\x89PNG\r\n\x1a\nrest";
    std::fs::write(folder.path().join("fig1.png"), png).unwrap();
    let content = Content {
        gallery: Some(index("fig1.png").unwrap()),
        ..Content::default()
    };
    let page = content.page().unwrap();
    let image = "src=\"data:image/png;base64,iVBORw0KGgpyZXN0\"";
    assert!(
        page.contains(image) && page.contains("fig1: &lt;i&gt;"),
        "{page}"
    );
    assert!(!content.missing().contains(&"gallery"));
    assert_self_contained(&page);
    for file in ["../fig1.png", "/etc/passwd", "a/fig1.png", "", ".."] {
        let error = index(file).unwrap_err();
        assert!(
            matches!(error, ReportError::Outside { .. }),
            "{file}: {error}"
        );
    }
    assert!(matches!(
        index("no.png").unwrap_err(),
        ReportError::Read { .. }
    ));
    write(folder.path(), "text.png", "text");
    assert!(matches!(
        index("text.png").unwrap_err(),
        ReportError::NoPng { .. }
    ));
    write(folder.path(), "index.json", "{}");
    let error = gallery::read(folder.path()).unwrap_err();
    assert!(matches!(error, ReportError::Json { .. }), "{error}");
}

#[test]
fn all_benches_run_unless_rows_are_taken_or_some_are_named() {
    let to_run = |words: &[&str]| -> Vec<&str> {
        let words = ["report", "-o", "x"].iter().chain(words);
        let line = Line::try_parse_from(words).unwrap();
        line.report.to_run().collect()
    };
    assert_eq!(to_run(&[]), NAMES);
    assert_eq!(to_run(&["--take", "a.json"]), [""; 0]);
    let some = to_run(&["--take", "a.json", "--run", "skip,table"]);
    assert_eq!(some, ["table", "skip"]);
}

#[test]
fn a_bench_that_is_run_is_part_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().to_str().unwrap();
    let line = ["report", "-o", output, "--run", "refine", "--quick"];
    let mut out = Vec::new();
    super::run(&Line::parse_from(line).report, &mut out).unwrap();
    let printed = String::from_utf8(out).unwrap();
    let is_right = printed.contains("missing: table") && !printed.contains("missing: refine");
    assert!(is_right, "{printed}");
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("refine.json") && page.contains("Octopus"));
}
