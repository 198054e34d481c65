//! The page as a whole: of what earlier runs wrote, of parts that are missing, of files that are bad.

use super::error::PageError;
use super::rows::{self, NAMES, Rows};
use super::{Content, ReportArguments, gallery};
use clap::Parser;
use std::path::{Path, PathBuf};

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    report: ReportArguments,
}

/// A file of the results in the repository.
fn shipped(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/xeon-2-threads");
    folder.join(name)
}

const SHIPPED: [&str; 7] = [
    "table_exact.json",
    "cut_exact.json",
    "refine.json",
    "step_llvmpipe.json",
    "accuracy/chain.csv",
    "stability.json",
    "skip.json",
];

fn content(files: &[PathBuf]) -> Content {
    let sources = files.iter().map(|path| rows::read(path).unwrap());
    Content {
        sources: sources.collect(),
        ..Content::default()
    }
}

/// What a page may load: nothing.
fn loads_nothing(page: &str) {
    for word in [
        "http:", "https:", "<script", "<link", "@import", "url(", "<iframe",
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
fn results_of_the_repository_make_a_page_of_all_parts() {
    let content = content(&SHIPPED.map(shipped));
    let names: Vec<&str> = content.sources.iter().map(|s| s.rows.name()).collect();
    assert_eq!(names, NAMES);
    assert_eq!(content.missing(), ["gallery"]);
    let page = content.page().unwrap();
    loads_nothing(&page);
    assert_eq!(page.matches("<svg").count(), 3, "cut, step and one scene");
    for text in [
        "Armadillo",
        "armadillo_30000_split.ply",
        "231.8",
        "7 of 80 laws fail",
        "1 of 33 claims fail",
        "Figure 11",
        "Intel(R) Xeon(R) Processor, 2 threads",
        "498ac7fc8fc3",
        "no folder of incise gallery",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("neither taken nor measured"));
    assert!(!page.contains("NaN") && !page.contains("null"));
}

#[test]
fn what_is_not_there_is_named() {
    let content = content(&[shipped("skip.json")]);
    let missing = [
        "table",
        "cut",
        "refine",
        "step",
        "accuracy",
        "stability",
        "gallery",
    ];
    assert_eq!(content.missing(), missing);
    let page = content.page().unwrap();
    for name in &missing[..6] {
        let told = format!("rows of {name} were neither taken nor measured");
        assert_eq!(page.matches(&told).count(), 1, "{name}");
    }
    let told = format!("Missing: {}.", missing.join(", "));
    assert!(page.contains(&told), "{told}");
    let mut content = Content::default();
    content.told.insert("step", "no <device>".to_owned());
    let page = content.page().unwrap();
    assert!(page.contains("The run said: no &lt;device&gt;"), "{page}");
    loads_nothing(&page);
}

#[test]
fn frame_rates_over_time_are_drawn_where_rows_have_them() {
    let text = std::fs::read_to_string(shipped("table_exact.json")).unwrap();
    let mut rows: serde_json::Value = serde_json::from_str(&text).unwrap();
    for row in rows.as_array_mut().unwrap() {
        row["pbd_fps_by_second"] = serde_json::json!([null, 100.0, 90.0]);
        row["pbd_cs_fps_by_second"] = serde_json::json!([80.0, 70.0, 60.0]);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "table.json", &rows.to_string());
    let page = content(&[path]).page().unwrap();
    assert_eq!(page.matches("<svg").count(), 2);
    assert!(page.contains("Figure 11a") && page.contains("Figure 11b"));
    assert!(!page.contains("an earlier version wrote them"));
    assert!(!page.contains("Unlike the paper's"), "it is as the paper's");
}

#[test]
fn a_table_of_bodies_with_an_inside_says_so() {
    let text = std::fs::read_to_string(shipped("table_exact.json")).unwrap();
    let mut rows: serde_json::Value = serde_json::from_str(&text).unwrap();
    for row in rows.as_array_mut().unwrap() {
        row["volume"] = true.into();
        row["contacts"] = true.into();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "table.json", &rows.to_string());
    let page = content(&[path]).page().unwrap();
    let said = "pieces keep their volumes, pieces touch each other.";
    assert!(page.contains(said), "{page}");
}

#[test]
fn text_of_files_is_no_markup() {
    let bad = "<img src=http://x onerror=alert(1)>&\"'";
    let folder = tempfile::tempdir().unwrap();
    let rows = serde_json::json!([{
        "skip": bad, "claim": bad, "at": bad, "bound": 1.0, "measured": null, "passed": false, "device": bad,
        "commit": bad,
    }]);
    let skip = write(folder.path(), "<b>.json", &rows.to_string());
    let rows = serde_json::json!([{
        "model": bad, "triangles": 10, "bodies": 1, "backend": bad, "device": bad, "schedule": bad,
        "ms_per_frame": 1.0, "refusal": bad,
    }]);
    let step = write(folder.path(), "step.json", &rows.to_string());
    let page = content(&[skip, step]).page().unwrap();
    assert!(!page.contains("<img") && !page.contains("<b>"), "{page}");
    assert!(page.contains("&lt;img src=http"), "it is there as text");
}

#[test]
fn files_that_are_bad_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let read = |name: &str, text: &str| {
        let path = write(folder, name, text);
        let error = rows::read(&path).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        error
    };
    for (i, text) in ["", "[{", "{\"a\": 1,}", "[1, 2", "\u{0}"]
        .into_iter()
        .enumerate()
    {
        let error = read(&format!("{i}.json"), text);
        assert!(matches!(error, PageError::Json { .. }), "{text}: {error}");
    }
    let short = "[{\"torture\": \"x\", \"law\": 3}]";
    assert!(matches!(read("short.json", short), PageError::Json { .. }));
    let one = "{\"torture\": \"x\", \"law\": \"y\"}";
    assert!(matches!(read("one.json", one), PageError::Json { .. }));
    assert!(matches!(read("empty.json", "[]"), PageError::Empty { .. }));
    for text in ["[{}]", "[1]", "3", "null", "[[]]", "[{\"program\": \"x\"}]"] {
        assert!(
            matches!(read("other.json", text), PageError::Unknown { .. }),
            "{text}"
        );
    }
    let names = "scene,backend,scheme,substeps,ms_per_frame,total_position,commit\n";
    for row in [
        "chain,cpu,xpbd,1,fast,,c",
        "chain,cpu,xpbd,1,2.0,x,c",
        "chain,cpu",
        "chain,cpu,xpbd,1.5,2,,c",
    ] {
        let error = read("rows.csv", &format!("{names}{row}\n"));
        assert!(
            matches!(error, PageError::Cell { line: 2, .. }),
            "{row}: {error}"
        );
    }
    assert!(matches!(
        read("other.csv", "a,b\n1,2\n"),
        PageError::Unknown { .. }
    ));
    assert!(matches!(read("none.csv", names), PageError::Empty { .. }));
    let missing = rows::read(&folder.join("nowhere.json")).unwrap_err();
    assert!(matches!(missing, PageError::Read { .. }), "{missing}");
    let good = write(
        folder,
        "good.csv",
        &format!("{names}chain,cpu,xpbd,1,2.0,,abc\n"),
    );
    let good = rows::read(&good).unwrap();
    assert!(matches!(&good.rows, Rows::Accuracy(rows) if rows.len() == 1));
    assert_eq!(good.commits, ["abc"]);
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
    assert!(
        page.contains("src=\"data:image/png;base64,iVBORw0KGgpyZXN0\""),
        "{page}"
    );
    assert!(page.contains("fig1: &lt;i&gt;"));
    assert!(!content.missing().contains(&"gallery"));
    loads_nothing(&page);
    for file in ["../fig1.png", "/etc/passwd", "a/fig1.png", "", ".."] {
        let error = index(file).unwrap_err();
        assert!(
            matches!(error, PageError::Outside { .. }),
            "{file}: {error}"
        );
    }
    assert!(matches!(
        index("no.png").unwrap_err(),
        PageError::Read { .. }
    ));
    write(folder.path(), "text.png", "text");
    assert!(matches!(
        index("text.png").unwrap_err(),
        PageError::NoPng { .. }
    ));
    write(folder.path(), "index.json", "{}");
    let error = gallery::read(folder.path()).unwrap_err();
    assert!(matches!(error, PageError::Json { .. }), "{error}");
}

#[test]
fn all_is_run_unless_rows_are_taken_or_some_are_named() {
    let to_run = |words: &[&str]| -> Vec<&str> {
        let words = ["report", "-o", "x"].iter().chain(words);
        let line = Line::try_parse_from(words).unwrap();
        line.report.to_run().collect()
    };
    assert_eq!(to_run(&[]), NAMES);
    assert_eq!(to_run(&["--take", "a.json"]), [""; 0]);
    assert_eq!(
        to_run(&["--take", "a.json", "--run", "skip,table"]),
        ["table", "skip"]
    );
}

#[test]
fn a_bench_that_is_run_is_part_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().to_str().unwrap();
    let line = ["report", "-o", output, "--run", "refine", "--quick"];
    let mut out = Vec::new();
    super::run(&Line::parse_from(line).report, &mut out).unwrap();
    let told = String::from_utf8(out).unwrap();
    assert!(
        told.contains("missing: table") && !told.contains("missing: refine"),
        "{told}"
    );
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("refine.json") && page.contains("Octopus"));
    let rows = rows::read(&folder.path().join("refine.json")).unwrap();
    assert!(matches!(rows.rows, Rows::Refine(_)));
}
