//! Sections as files that other programs read: an OBJ each, see `crates/bench/peers/README.md`.

use super::rims::{self, Rims};
use super::row::Stamp;
use super::{COMPARED, RefineArguments};
use crate::subject::Subject;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Writes the sections of all subjects into a new folder, or an empty one: files of an earlier run would
/// be taken for sections of this one.
pub(super) fn run(
    folder: &Path,
    arguments: &RefineArguments,
    subjects: &[Subject],
    stamp: &Stamp,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    claim(folder).map_err(|fault| format!("{}: {fault}", folder.display()))?;
    for subject in subjects {
        for (planes, _, all, failures) in rims::of(subject, &[COMPARED], arguments.planes, stamp)? {
            for (k, rims) in all.iter().enumerate() {
                let path = folder.join(file_name(&subject.name, planes, k));
                let text = obj(&subject.name, planes, k, rims);
                fs::write(&path, text).map_err(|fault| format!("{}: {fault}", path.display()))?;
            }
            let loops = all.iter().filter(|rims| !rims.is_one_loop()).count();
            writeln!(
                out,
                "{} {planes}: {} sections, {loops} of several loops",
                subject.name,
                all.len()
            )?;
            for failure in failures {
                writeln!(out, "  failed: {failure}")?;
            }
        }
    }
    Ok(())
}

/// Makes a folder where there is none, and refuses one with anything in it.
fn claim(folder: &Path) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|fault| fault.to_string())?;
    let mut entries = fs::read_dir(folder).map_err(|fault| fault.to_string())?;
    match entries.next() {
        None => Ok(()),
        Some(_) => Err("not empty: give a new folder for the rims".to_owned()),
    }
}

fn file_name(model: &str, planes: &str, section: usize) -> String {
    format!("{model}-{planes}-{section:03}.obj")
}

/// A section as text. Numbers have as many digits as bring back the same bits. No section has a
/// crease: planes are flat.
fn obj(model: &str, planes: &str, k: usize, rims: &Rims) -> String {
    let section = rims.section();
    let mut text = format!(
        "# model {model}\n# planes {planes}\n# section {k}\n# rims {}\n# target {}\n# targets",
        rims.fingerprint(),
        rims.target()
    );
    for length in rims.lengths() {
        // Writing to a text cannot fail.
        let _ = write!(text, " {length}");
    }
    text.push('\n');
    for [x, y] in section.points {
        let _ = writeln!(text, "v {x} {y} 0");
    }
    for points in section.loops {
        text.push('l');
        for p in points.iter().chain(points.first()) {
            let _ = write!(text, " {}", p + 1);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subject;
    use clap::Parser;

    /// What any reader of the format does.
    fn read(text: &str) -> ([String; 4], f64, Rims) {
        let comment = |key: &str| {
            let line = text
                .lines()
                .find_map(|line| line.strip_prefix(&format!("# {key} ")));
            line.unwrap().to_owned()
        };
        let numbers = |line: &str| -> Vec<f64> {
            let words = line.split_whitespace();
            words.map(|word| word.parse().unwrap()).collect()
        };
        let (mut points, mut loops) = (Vec::new(), Vec::new());
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("v ") {
                let at = numbers(rest);
                assert_eq!((at.len(), at[2]), (3, 0.0), "in the plane");
                points.push([at[0], at[1]]);
            } else if let Some(rest) = line.strip_prefix("l ") {
                let words = rest.split_whitespace();
                let mut corners: Vec<u32> = words.map(|p| p.parse::<u32>().unwrap() - 1).collect();
                assert_eq!(corners.pop(), corners.first().copied(), "closed");
                loops.push(corners);
            }
        }
        let names = ["model", "planes", "section", "rims"].map(comment);
        let target = comment("target").parse().unwrap();
        let rims = Rims::new(points, loops, numbers(&comment("targets")));
        (names, target, rims)
    }

    fn same(a: &Rims, b: &Rims) {
        assert_eq!(a.section().points, b.section().points, "bit for bit");
        assert_eq!(a.section().loops, b.section().loops);
        assert_eq!(a.section().crease, b.section().crease);
        assert_eq!(a.lengths(), b.lengths());
        assert_eq!(a.fingerprint(), b.fingerprint());
    }

    fn nested() -> Rims {
        let square = |half: f64| [[-half, -half], [half, -half], [half, half], [-half, half]];
        let points = [square(1.0), square(1.0 / 3.0)].concat();
        let loops = vec![vec![0, 1, 2, 3], vec![7, 6, 5, 4]];
        Rims::new(points, loops, (0..8).map(|i| 0.1 + f64::from(i)).collect())
    }

    #[test]
    fn what_was_written_reads_back_the_same() {
        let rims = nested();
        let (names, target, back) = read(&obj("Bunny", "seeded", 7, &rims));
        assert_eq!(
            names,
            ["Bunny", "seeded", "7", &rims.fingerprint()].map(str::to_owned)
        );
        assert!(
            (target - 3.6).abs() < 1e-12,
            "the mean of 0.1 to 7.1: {target}"
        );
        same(&rims, &back);
    }

    #[test]
    fn every_part_of_a_section_is_in_its_fingerprint() {
        let rims = nested();
        let (points, loops) = (rims.section().points.to_vec(), rims.section().loops);
        let mut others = vec![rims.fingerprint()];
        let mut moved = points.clone();
        moved[3][1] = moved[3][1].next_up();
        others.push(Rims::new(moved, loops.to_vec(), rims.lengths().to_vec()).fingerprint());
        let one = vec![loops.concat()];
        others.push(Rims::new(points.clone(), one, rims.lengths().to_vec()).fingerprint());
        let mut lengths = rims.lengths().to_vec();
        lengths[7] = 7.0;
        others.push(Rims::new(points, loops.to_vec(), lengths).fingerprint());
        others.sort();
        others.dedup();
        assert_eq!(others.len(), 4, "{others:?}");
    }

    #[test]
    fn a_folder_gets_the_sections_of_one_run_only() {
        #[derive(Parser)]
        struct Line {
            #[command(flatten)]
            refine: RefineArguments,
        }
        let arguments = Line::parse_from(["", "--planes", "2"]).refine;
        let folder = tempfile::tempdir().unwrap();
        let subjects = subject::list(None, &["Sphere80".to_owned()], 100).unwrap();
        let stamp = Stamp {
            snap: 0.1,
            seed: 1,
            ..Stamp::default()
        };
        let path = folder.path().join("rims");
        let write = || run(&path, &arguments, &subjects, &stamp, &mut Vec::new());
        write().unwrap();
        for (planes, count) in [("middle", 1), ("seeded", 2)] {
            let cuts = rims::of(&subjects[0], &[COMPARED], 2, &stamp).unwrap();
            let (_, _, all, _) = cuts.iter().find(|cuts| cuts.0 == planes).unwrap();
            assert_eq!(all.len(), count, "every plane hits");
            for (k, rims) in all.iter().enumerate() {
                let file = path.join(file_name("Sphere80", planes, k));
                same(rims, &read(&fs::read_to_string(file).unwrap()).2);
            }
        }
        assert_eq!(fs::read_dir(&path).unwrap().count(), 3);
        let refused = write().unwrap_err().to_string();
        assert!(refused.contains("not empty"), "{refused}");
    }
}
