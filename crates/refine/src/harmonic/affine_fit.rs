//! Least squares fit of an affine function to values at the points of loops.

use crate::section_mesh::Section;

/// A direction thinner than this share of the other one's extent has no slope.
const MIN_EXTENT: f64 = 1e-9;

/// An affine function on the plane, and its error.
#[derive(Debug, Clone, Copy)]
pub(super) struct AffineFit {
    center: [f64; 2],
    mean: [f64; 3],
    /// Derivatives by x and y.
    slopes: [[f64; 3]; 2],
    /// Largest error of each coordinate.
    pub(super) error: [f64; 3],
}

impl AffineFit {
    /// Fits the points of the loops.
    pub(super) fn fit(section: &Section<'_>, values: &[[f64; 3]]) -> Self {
        let points = || {
            let all = section.loops.iter().flatten().map(|&p| p as usize);
            all.map(|p| (section.points[p], values[p]))
        };
        let (mut count, mut center, mut mean) = (0.0_f64, [0.0; 2], [0.0; 3]);
        for (at, value) in points() {
            count += 1.0;
            center = [0, 1].map(|k| center[k] + at[k]);
            mean = [0, 1, 2].map(|k| mean[k] + value[k]);
        }
        let share = 1.0 / count.max(1.0);
        let mut fit = Self {
            center: center.map(|x| share * x),
            mean: mean.map(|x| share * x),
            slopes: [[0.0; 3]; 2],
            error: [0.0; 3],
        };
        fit.find_slopes(points);
        for (at, value) in points() {
            let found = fit.at(at);
            for (k, most) in fit.error.iter_mut().enumerate() {
                let off = (found[k] - value[k]).abs();
                // Written so that NaN counts as a large error.
                *most = if off <= *most { *most } else { off };
            }
        }
        fit
    }

    /// Fits one direction after the other; normal equations would lose half of the digits.
    fn find_slopes<I: Iterator<Item = ([f64; 2], [f64; 3])>>(&mut self, points: impl Fn() -> I) {
        let offset = |at: [f64; 2]| [at[0] - self.center[0], at[1] - self.center[1]];
        let mut squares = [0.0; 2];
        let mut mixed = 0.0;
        for (at, _) in points() {
            let [x, y] = offset(at);
            squares = [squares[0] + x * x, squares[1] + y * y];
            mixed += x * y;
        }
        // `a` is the direction of the larger extent.
        let a = usize::from(squares[1] > squares[0]);
        let b = 1 - a;
        if squares[a] <= 0.0 {
            return;
        }
        let slope_ratio = mixed / squares[a];
        let (mut along, mut across, mut rest) = ([0.0; 3], [0.0; 3], 0.0);
        for (at, value) in points() {
            let place = offset(at);
            let beside = place[b] - slope_ratio * place[a];
            rest += beside * beside;
            for k in 0..3 {
                along[k] += place[a] * (value[k] - self.mean[k]);
                across[k] += beside * (value[k] - self.mean[k]);
            }
        }
        let across = if rest > MIN_EXTENT * MIN_EXTENT * squares[a] {
            across.map(|x| x / rest)
        } else {
            [0.0; 3]
        };
        self.slopes[b] = across;
        self.slopes[a] = [0, 1, 2].map(|k| along[k] / squares[a] - slope_ratio * across[k]);
    }

    /// Evaluates the function.
    pub(super) fn at(&self, at: [f64; 2]) -> [f64; 3] {
        let [x, y] = [at[0] - self.center[0], at[1] - self.center[1]];
        [0, 1, 2].map(|k| self.mean[k] + x * self.slopes[0][k] + y * self.slopes[1][k])
    }
}
