//! [`BladePath`]: the poses of a moving blade, read from the file of `--path`.

use crate::failure::Failure;
use crate::numbers::counted;
use incise_mesh::Vec3;
use incise_mesh::geometry::to_f32;
use std::path::Path;

/// A pose of the blade.
#[derive(Debug, Clone, PartialEq)]
struct Pose {
    /// Its line in the file, from 1.
    line: usize,
    /// The points of its edge in the file's coordinates.
    points: Vec<[f64; 3]>,
}

/// A pose of a straight blade in the file's coordinates \[m\], and its line.
pub(crate) type StraightPose = (usize, [[f64; 3]; 2]);

/// The poses of a moving blade: two or more, each with the same number of points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BladePath {
    poses: Vec<Pose>,
}

/// A reason why a file is not the path of a blade.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BladePathError {
    /// The file cannot be read.
    #[error("the path of the blade cannot be read: {0}")]
    Read(std::io::Error),
    /// The file is not text.
    #[error("line {line}: this is not text; write one pose per line, x y z of each point")]
    NotText {
        /// The first line with invalid UTF-8.
        line: usize,
    },
    /// A word is not a number.
    #[error("line {line}: '{word}' is not a number; separate numbers by spaces")]
    NotNumber {
        /// The line.
        line: usize,
        /// The word.
        word: String,
    },
    /// A number is NaN, infinite or too large.
    #[error("line {line}: '{word}' is not finite in 32 bits; write finite coordinates")]
    NotFinite {
        /// The line.
        line: usize,
        /// The number.
        word: String,
    },
    /// The numbers of a pose are not x, y and z of points.
    #[error(
        "line {line}: {}; write x, y and z of each point of the blade",
        counted(*found, "number")
    )]
    NotPoints {
        /// The line.
        line: usize,
        /// The number of numbers.
        found: usize,
    },
    /// A pose is a point.
    #[error("line {line}: the blade has 1 point; write at least 2 points, its start and end")]
    OnePoint {
        /// The line.
        line: usize,
    },
    /// Two poses have different numbers of points.
    #[error(
        "line {line}: the blade has {found} points, but {expected} on line {first}; write the \
         same number on every line"
    )]
    PointCount {
        /// The line.
        line: usize,
        /// Its number of points.
        found: usize,
        /// The line of the first pose.
        first: usize,
        /// The number of points there.
        expected: usize,
    },
    /// The file has no pose.
    #[error("the file has no pose of the blade; write one per line, x y z of each point")]
    NoPose,
    /// The file has one pose.
    #[error("line {line}: this is the only pose; a cut needs at least 2, one per line")]
    OnePose {
        /// The line of the pose.
        line: usize,
    },
    /// No motion of the blade has an area.
    #[error("the blade has no length, or it never moves across its edge")]
    NoMotion,
    /// A pose has another number of points than two.
    #[error(
        "line {line}: the blade has {found} points; blades of simulations have 2, its start and \
         end"
    )]
    NotStraight {
        /// The line of the first pose.
        line: usize,
        /// The number of points.
        found: usize,
    },
}

impl BladePath {
    /// Reads the file of a path.
    pub(crate) fn read(file: &Path) -> Result<Self, Failure> {
        let bytes = std::fs::read(file).map_err(BladePathError::Read);
        let path = bytes.and_then(|bytes| Self::parse(&bytes));
        path.map_err(|source| Failure::Path {
            path: file.to_owned(),
            source,
        })
    }

    fn parse(bytes: &[u8]) -> Result<Self, BladePathError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = str::from_utf8(bytes).map_err(|error| {
            let before = &bytes[..error.valid_up_to()];
            let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
            BladePathError::NotText { line }
        })?;
        let mut poses: Vec<Pose> = Vec::new();
        for (line, text) in (1..).zip(text.lines()) {
            let content = text.split('#').next().unwrap_or_default();
            let numbers = (content.split_whitespace())
                .map(|word| number(line, word))
                .collect::<Result<Vec<f64>, _>>()?;
            if numbers.is_empty() {
                continue;
            }
            let (points, rest) = numbers.as_chunks::<3>();
            if !rest.is_empty() {
                let found = numbers.len();
                return Err(BladePathError::NotPoints { line, found });
            }
            if points.len() < 2 {
                return Err(BladePathError::OnePoint { line });
            }
            if let Some(first) = poses.first()
                && first.points.len() != points.len()
            {
                return Err(BladePathError::PointCount {
                    line,
                    found: points.len(),
                    first: first.line,
                    expected: first.points.len(),
                });
            }
            let points = points.to_vec();
            poses.push(Pose { line, points });
        }
        match *poses.as_slice() {
            [] => Err(BladePathError::NoPose),
            [Pose { line, .. }] => Err(BladePathError::OnePose { line }),
            _ => Ok(Self { poses }),
        }
    }

    /// Returns the number of poses.
    pub(crate) fn len(&self) -> usize {
        self.poses.len()
    }

    /// Iterates over the poses relative to an origin \[m\], each with its line in the file.
    pub(crate) fn poses(
        &self,
        origin: [f64; 3],
    ) -> impl ExactSizeIterator<Item = (usize, Vec<[f32; 3]>)> {
        let origin = Vec3::from(origin);
        self.poses.iter().map(move |pose| {
            let point = |&p: &[f64; 3]| to_f32(Vec3::from(p) - origin);
            (pose.line, pose.points.iter().map(point).collect())
        })
    }

    /// Returns the poses of a straight blade.
    pub(crate) fn straight_poses(&self) -> Result<Vec<StraightPose>, BladePathError> {
        let straight = |&Pose { line, ref points }: &Pose| {
            let found = points.len();
            let pose = <[[f64; 3]; 2]>::try_from(points.as_slice());
            let pose = pose.map_err(|_| BladePathError::NotStraight { line, found })?;
            Ok((line, pose))
        };
        self.poses.iter().map(straight).collect()
    }
}

/// Parses a coordinate that 32 bits can hold.
fn number(line: usize, word: &str) -> Result<f64, BladePathError> {
    let word_of_error = || word.to_owned();
    let value: f64 = word.parse().map_err(|_| BladePathError::NotNumber {
        line,
        word: word_of_error(),
    })?;
    // NaN is in no range.
    if value.abs() <= f64::from(f32::MAX) {
        Ok(value)
    } else {
        Err(BladePathError::NotFinite {
            line,
            word: word_of_error(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &[u8]) -> String {
        BladePath::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn comments_blank_lines_and_line_ends_of_any_system_are_skipped() {
        let text = "\u{feff}# knife\r\n\r\n0 0 -1\t0 0 1 # start\r\n  \n1 0 -1 1 0 1";
        let path = BladePath::parse(text.as_bytes()).unwrap();
        assert_eq!(path.len(), 2);
        let poses: Vec<_> = path.poses([1.0, 0.0, 0.0]).collect();
        assert_eq!(poses[0], (3, vec![[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0]]));
        assert_eq!(poses[1], (5, vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]));
        let straight = path.straight_poses().unwrap();
        assert_eq!(straight[1], (5, [[1.0, 0.0, -1.0], [1.0, 0.0, 1.0]]));
    }

    /// Near 1e6 the spacing of 32-bit numbers is 0.06.
    #[test]
    fn the_origin_is_subtracted_before_rounding() {
        let text = "1000000.001 0 0 1000000.002 0 0\n".repeat(2);
        let path = BladePath::parse(text.as_bytes()).unwrap();
        let (_, pose) = path.poses([1e6, 0.0, 0.0]).next().unwrap();
        for (point, expected) in pose.iter().zip([0.001, 0.002]) {
            assert!((point[0] - expected).abs() < 1e-9, "{}", point[0]);
        }
    }

    #[test]
    fn every_error_names_its_line() {
        for (text, said) in [
            (&b""[..], "no pose"),
            (b"# only this\n\n", "no pose"),
            (b"\n0 0 0 1 0 0\n", "line 2: this is the only pose"),
            (b"#\n0 0 0 1 0\n", "line 2: 5 numbers;"),
            (b"0\n", "line 1: 1 number;"),
            (b"0 0 0\n", "line 1: the blade has 1 point"),
            (
                b"0 0 0 1 0 0\n\n0 0 0 1 0 0 2 0 0\n",
                "line 3: the blade has 3 points, but 2 on line 1",
            ),
            (b"0 0 0 1 0 nan\n", "line 1: 'nan' is not finite"),
            (b"0 0 0 1 0 -inf\n", "line 1: '-inf' is not finite"),
            (b"0 0 0 1 0 1e39\n", "line 1: '1e39' is not finite"),
            (b"0,0,0,1,0,0\n", "line 1: '0,0,0,1,0,0' is not a number"),
            (b"0 0 0 1 0 0\n1 0 0 two 0 0\n", "line 2: 'two' is not"),
            (b"0 0 0 1 0 0\n\xff\n", "line 2: this is not text"),
        ] {
            let error = error(text);
            assert!(error.contains(said), "{error}, not {said}");
        }
        let three = b"0 0 0 1 0 0 2 0 0\n".repeat(2);
        let curved = BladePath::parse(&three).unwrap();
        let error = curved.straight_poses().unwrap_err().to_string();
        assert!(error.contains("line 1: the blade has 3 points"), "{error}");
    }
}
