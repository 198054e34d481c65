//! Dotted names of parameters: all of a struct, and the one that a short name means.

use crate::{Field, Kind, ParamError, Value};

/// Returns all parameters of a struct with their dotted names, those of nested structs included.
#[must_use]
pub fn all_fields(fields: &'static [Field]) -> Vec<(String, &'static Field)> {
    let mut out = Vec::new();
    append(&mut out, "", fields);
    out
}

fn append(out: &mut Vec<(String, &'static Field)>, prefix: &str, fields: &'static [Field]) {
    for field in fields {
        let name = match prefix {
            "" => field.name.to_owned(),
            prefix => format!("{prefix}.{}", field.name),
        };
        out.push((name.clone(), field));
        if let Kind::Struct(fields) = field.kind.inner() {
            append(out, &name, fields);
        }
    }
}

/// Returns the dotted name of the parameter that a name means.
///
/// The name may leave out leading parts and have underscores or dashes in place of dots. The
/// parameter with the fewest parts is meant.
///
/// # Errors
/// [`ParamError::Unknown`], and [`ParamError::Ambiguous`] if several have as many parts.
pub fn resolve(fields: &'static [Field], name: &str) -> Result<String, ParamError> {
    if let Some(field) = fields.iter().find(|field| field.name == name) {
        return Ok(field.name.to_owned());
    }
    let all = all_fields(fields);
    let mut found: Vec<String> = Vec::new();
    for (path, field) in &all {
        let is_switch = matches!(field.kind, Kind::Optional(Kind::Struct(_)));
        let switch = is_switch.then(|| format!("{path}.enabled"));
        // The value of an alternative: `stretch.compliance`.
        let alternatives = match field.kind.inner() {
            Kind::Variants(variants) => *variants,
            _ => &[],
        };
        let alternatives = alternatives.iter().map(|v| format!("{path}.{}", v.name));
        let paths = [path.clone()].into_iter().chain(switch).chain(alternatives);
        found.extend(paths.filter(|path| means(path, name)));
    }
    let parts = |path: &String| path.split('.').count();
    let fewest = found.iter().map(parts).min();
    found.retain(|path| Some(parts(path)) == fewest);
    match found.as_slice() {
        [path] => Ok(path.clone()),
        [] => {
            let leaves = all
                .iter()
                .filter(|(_, field)| !matches!(field.kind, Kind::Struct(_)));
            let known: Vec<&str> = leaves.map(|(path, _)| path.as_str()).collect();
            Err(ParamError::Unknown {
                name: name.chars().take(40).collect(),
                known: known.join(", "),
            })
        }
        several => Err(ParamError::Ambiguous {
            name: name.to_owned(),
            known: several.join(", "),
        }),
    }
}

/// Appends the parameters that a map and the maps in it give: dotted names and given ones.
///
/// Both are behind `prefix`. Unknown names are left out.
pub(crate) fn append_given(
    out: &mut Vec<(String, String)>,
    fields: &'static [Field],
    prefix: [&str; 2],
    entries: &[(String, Value)],
) {
    for (name, value) in entries {
        let Ok(path) = resolve(fields, name) else {
            continue;
        };
        let all = all_fields(fields);
        let field = all.iter().find(|(own, _)| *own == path);
        let [path, name] = [0, 1].map(|i: usize| match prefix[i] {
            "" => [&path, name][i].clone(),
            prefix => format!("{prefix}.{}", [&path, name][i]),
        });
        match (value, field.map(|(_, field)| field.kind.inner())) {
            (Value::Map(inner), Some(Kind::Struct(fields))) => {
                append_given(out, fields, [&path, &name], inner);
            }
            _ => out.push((path, name)),
        }
    }
}

/// Returns the shortest name of a parameter, with the names of optional structs around it.
#[must_use]
pub fn short_name(fields: &'static [Field], path: &str) -> String {
    let all = all_fields(fields);
    let optional = all
        .iter()
        .filter(|(_, field)| matches!(field.kind, Kind::Optional(_)));
    let inside = optional.filter(|(outer, _)| {
        path.strip_prefix(outer.as_str())
            .is_some_and(|rest| rest.starts_with('.'))
    });
    // The outermost optional struct is part of the name.
    let keep = inside
        .map(|(outer, _)| outer.len())
        .min()
        .map_or(path.len(), |length| {
            path[..length].rfind('.').map_or(0, |dot| dot + 1)
        });
    let starts: Vec<usize> = path.match_indices('.').map(|(dot, _)| dot + 1).collect();
    let starts = starts
        .into_iter()
        .rev()
        .chain([0])
        .filter(|&start| start <= keep);
    let mut names = starts.map(|start| &path[start..]);
    let found = names.find(|name| resolve(fields, name).is_ok_and(|found| found == path));
    found.unwrap_or(path).to_owned()
}

/// Returns whether a name is the end of a dotted name.
fn means(path: &str, name: &str) -> bool {
    let plain = |c| if c == '-' || c == '.' { '_' } else { c };
    let starts = path.match_indices('.').map(|(i, _)| i + 1);
    let ends = [0].into_iter().chain(starts).map(|start| &path[start..]);
    let same = |end: &str| end.chars().map(plain).eq(name.chars().map(plain));
    ends.into_iter().any(same)
}

/// Returns the first part of a dotted name, and the rest.
#[must_use]
pub fn split(path: &str) -> (&str, &str) {
    path.split_once('.').unwrap_or((path, ""))
}
