//! The page of `incise-bench report` in a browser. Without one these tests show as ignored; with
//! `INCISE_REQUIRE_GPU` set, as in CI, they fail.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};

const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
const WIDTH: u32 = 1200;
const HEIGHT: u32 = 4000;

fn main() -> ExitCode {
    let trials = vec![
        browsing("a_browser_shows_tables_and_charts", shown),
        browsing("a_browser_prints_the_page", printed),
        Trial::test("files_that_are_bad_are_refused", || {
            bad_files();
            Ok(())
        }),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// A test that needs a browser.
fn browsing(name: &'static str, test: fn(&str)) -> Trial {
    Trial::ignorable_test(name, move || {
        let Some(browser) = browser() else {
            return without_browser();
        };
        test(browser);
        Ok(Completion::Completed)
    })
}

fn browser() -> Option<&'static str> {
    let answers = |name: &&str| {
        let asked = Command::new(name).arg("--version").output();
        asked.is_ok_and(|output| output.status.success())
    };
    BROWSERS.into_iter().find(answers)
}

fn without_browser() -> Result<Completion, Failed> {
    let absent = "there is no chromium; on Debian install chromium";
    let required = std::env::var("INCISE_REQUIRE_GPU").unwrap_or_default();
    if ["", "0"].contains(&required.as_str()) {
        Ok(Completion::ignored_with(absent))
    } else {
        Err(format!("INCISE_REQUIRE_GPU is set, and {absent}").into())
    }
}

fn bench(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_incise-bench");
    Command::new(program)
        .args(arguments)
        .output()
        .expect("it runs")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path of letters")
}

/// A page of results that are in the repository.
fn page(folder: &Path) -> PathBuf {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/xeon-2-threads");
    let files = [
        "table_exact.json",
        "cut_exact.json",
        "accuracy/chain.csv",
        "stability.json",
        "skip.json",
    ];
    let files = files.map(|name| results.join(name));
    let mut words = vec!["report", "-o", text(folder), "--take"];
    words.extend(files.iter().map(|path| text(path)));
    let output = bench(&words);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("missing: refine"), "{told}");
    folder.join("report.html")
}

/// Opens the page, with options of what to do with it, and returns what the browser prints.
fn browse(browser: &str, folder: &Path, more: &[String]) -> String {
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let address = format!("file://{}", folder.join("report.html").display());
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
        ])
        .arg(format!("--window-size={WIDTH},{HEIGHT}"))
        .args([profile, address])
        .args(more)
        .output()
        .expect("a browser");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Red, green and blue of all pixels, row by row.
fn pixels(path: &Path) -> Vec<Vec<[u8; 3]>> {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    assert_eq!((info.width, info.height), (WIDTH, HEIGHT));
    let channels = info.color_type.samples();
    let pixels: Vec<[u8; 3]> = bytes[..info.buffer_size()]
        .chunks(channels)
        .map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    pixels.chunks(WIDTH as usize).map(<[_]>::to_vec).collect()
}

/// Letters and lines.
fn is_dark(pixel: &[u8; 3]) -> bool {
    pixel.iter().all(|&c| c < 110)
}

fn shown(browser: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    page(folder);
    let picture = folder.join("page.png");
    let shot = format!("--screenshot={}", picture.display());
    browse(browser, folder, &[shot]);
    let rows = pixels(&picture);
    // The background of a table's head, as the style has it.
    const HEAD: [u8; 3] = [0xe4, 0xeb, 0xf5];
    let is_head = |row: &Vec<[u8; 3]>| row.iter().filter(|&&pixel| pixel == HEAD).count() > 700;
    let heads: Vec<usize> = (1..rows.len())
        .filter(|&y| is_head(&rows[y]) && !is_head(&rows[y - 1]))
        .collect();
    assert!(
        heads.len() >= 4,
        "tables of sources, rates, cuts and cuts of all sizes: {heads:?}"
    );
    for &y in &heads[..4] {
        let below = rows[y..(y + 120).min(rows.len())].iter().flatten();
        let letters = below.filter(|pixel| is_dark(pixel)).count();
        assert!(letters > 1000, "the table at {y} is empty: {letters}");
    }
    // A chart's first line has this color.
    let blue = rows
        .iter()
        .flatten()
        .filter(|&&[r, g, b]| r < 60 && (60..130).contains(&g) && b > 150);
    assert!(blue.count() > 300, "no chart");
    for (y, row) in rows.iter().enumerate() {
        let edges = row[..8].iter().chain(&row[row.len() - 8..]);
        assert!(
            edges.clone().all(|&pixel| pixel == [255; 3]),
            "something sticks out at {y}"
        );
    }
    let dark = rows.iter().flatten().filter(|pixel| is_dark(pixel)).count();
    let all = (WIDTH * HEIGHT) as usize;
    assert!(dark < all / 10, "paper is white: {dark} of {all}");
    let dom = browse(browser, folder, &["--dump-dom".to_owned()]);
    for word in ["Armadillo", "7 of 80 invariants fail", "<svg", "</html>"] {
        assert!(dom.contains(word), "{word}");
    }
    for word in ["ERR_", "parsererror", "NaN", "undefined"] {
        assert!(!dom.contains(word), "{word}");
    }
}

fn printed(browser: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    page(folder);
    let sheet = folder.join("page.pdf");
    let print = format!("--print-to-pdf={}", sheet.display());
    browse(browser, folder, &[print]);
    let bytes = std::fs::read(&sheet).expect("a PDF");
    assert!(bytes.starts_with(b"%PDF"));
    let pages = bytes.windows(11).filter(|w| w == b"/Type /Page").count();
    assert!(pages > 3, "{pages} sheets");
}

fn bad_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let bad = folder.path().join("bad.json");
    std::fs::write(&bad, "[{\"pbd_fps\": 1, \"pbd_cs_fps\": 2}").expect("a folder");
    let out = folder.path().join("out");
    let output = bench(&["report", "-o", text(&out), "--take", text(&bad)]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(error.contains("bad.json"), "{error}");
    assert!(!out.join("report.html").exists(), "there is no page of it");
}
