//! Mass and velocities of a few vertices set so that their sums are what they were: mass, center of mass,
//! momentum and angular momentum.

use incise_mesh::{Vec3, VertexId};
use nalgebra::{Matrix3, SymmetricEigen};

/// How often masses are tilted. Every round changes one by three quarters at most.
const ROUNDS: usize = 8;

/// The most that one axis changes masses in a round.
const TILT: f64 = 0.25;

/// How fast a correction may move a vertex about one axis, or all of them along, against the fastest of
/// those who had the mass.
const FASTEST: f64 = 4.0;

/// How far vertices must be from the others' plane or line, against the farthest one, for it to be more than
/// a rounding of their places.
const THIN: f64 = 1e-6;

/// What vertices carry together, about a point of reference: sums of mass \[kg\], of mass times place,
/// of mass times velocity, of the latter's moment; and the highest speed [m/s].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Carried {
    pub(crate) mass: f64,
    pub(crate) moment: Vec3,
    pub(crate) momentum: Vec3,
    pub(crate) spin: Vec3,
    pub(crate) fastest: f64,
}

impl Carried {
    pub(crate) fn of(mass: f64, at: Vec3, velocity: Vec3) -> Self {
        let momentum = velocity * mass;
        Self {
            mass,
            moment: at * mass,
            momentum,
            spin: at.cross(&momentum),
            fastest: velocity.norm(),
        }
    }

    /// Adds a share of what others carry.
    pub(crate) fn add(&mut self, other: &Self, share: f64) {
        self.mass += other.mass * share;
        self.moment += other.moment * share;
        self.momentum += other.momentum * share;
        self.spin += other.spin * share;
        self.fastest = self.fastest.max(other.fastest);
    }
}

/// A vertex that shares in what others leave.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heir {
    pub(crate) vertex: VertexId,
    /// Where it is, from the point of reference \[m\].
    pub(crate) at: Vec3,
    /// What it weighs \[kg\].
    pub(crate) mass: f64,
    /// Whether it can be pushed.
    pub(crate) is_free: bool,
}

/// How mass lies about its center.
#[derive(Debug, Clone, Copy, Default)]
struct Spread {
    mass: f64,
    moment: Vec3,
    /// The sum of mass times place times place.
    second: Matrix3<f64>,
}

impl Spread {
    fn add(&mut self, mass: f64, at: Vec3) {
        let moment = at * mass;
        self.mass += mass;
        self.moment += moment;
        self.second += moment * at.transpose();
    }

    fn center(&self) -> Vec3 {
        self.moment / self.mass
    }

    /// The second moment about the center.
    fn central(&self) -> Matrix3<f64> {
        self.second - self.moment * self.center().transpose()
    }
}

/// The axes of a second moment with its values; none of numbers that are not finite.
fn axes(second: Matrix3<f64>) -> Option<[(Vec3, f64); 3]> {
    let parts = SymmetricEigen::try_new(second, f64::EPSILON, 64)?;
    let axis = |k: usize| {
        (
            parts.eigenvectors.column(k).into_owned(),
            parts.eigenvalues[k],
        )
    };
    Some([0, 1, 2].map(axis))
}

/// Shifts mass between heirs so that their center is where `moment` says: else a body that flies straight on
/// would have to spin after a cut, to keep its angular momentum about a fixed point. Masses get a factor
/// that is linear in space, between a quarter and seven quarters a round, so a center that is out of reach
/// is approached only.
pub(crate) fn keep_center(heirs: &mut [Heir], moment: Vec3) {
    let mut spread = Spread::default();
    for heir in &*heirs {
        spread.add(heir.mass, heir.at);
    }
    for _ in 0..ROUNDS {
        let (center, off) = (spread.center(), moment - spread.moment);
        let Some(axes) = axes(spread.central()) else {
            return;
        };
        let mut reach = [0.0_f64; 3];
        for heir in &*heirs {
            for (reach, (axis, _)) in reach.iter_mut().zip(&axes) {
                *reach = reach.max((heir.at - center).dot(axis).abs());
            }
        }
        let mut tilt = Vec3::zeros();
        let mut is_limited = false;
        let farthest = reach.into_iter().fold(THIN * center.norm(), f64::max);
        for ((axis, second), reach) in axes.into_iter().zip(reach) {
            let (limit, wanted) = (TILT / reach, off.dot(&axis) / second);
            if reach > THIN * farthest && wanted.is_finite() {
                tilt += axis * wanted.clamp(-limit, limit);
                is_limited |= wanted.abs() > limit;
            }
        }
        spread = Spread::default();
        for heir in &mut *heirs {
            heir.mass *= 1.0 + (heir.at - center).dot(&tilt);
            spread.add(heir.mass, heir.at);
        }
        if !is_limited {
            return;
        }
    }
}

/// Moves the free ones of `heirs` as a rigid body on top of how they move, so that all together have the
/// momentum of `was` and its angular momentum about the center of mass. If that is where it was, then
/// about any fixed point too.
///
/// What they cannot take stays undone: free heirs on a line do not turn about it, a single one does not
/// turn at all. And no more than [`FASTEST`] times the highest speed of those who had the mass is put
/// onto anyone along, or about any of the three axes: the kinetic energy stays bounded by that speed. A
/// free pool without pins never needs more than twice it along, and more about an axis only where mass
/// comes much closer to the axis than it was.
pub(crate) fn keep_momentum(heirs: &[Heir], velocities: &mut [[f32; 4]], was: &Carried) {
    let velocity = |velocities: &[[f32; 4]], heir: &Heir| {
        let [x, y, z, _] = velocities[heir.vertex.index()];
        Vec3::new(x.into(), y.into(), z.into())
    };
    let (mut now, mut free) = (Carried::default(), Spread::default());
    for heir in heirs {
        now.add(
            &Carried::of(heir.mass, heir.at, velocity(velocities, heir)),
            1.0,
        );
        if heir.is_free {
            free.add(heir.mass, heir.at);
        }
    }
    if free.mass <= 0.0 {
        return;
    }
    let limit = FASTEST * was.fastest;
    let mut along = (was.momentum - now.momentum) / free.mass;
    if along.norm() > limit {
        along *= limit / along.norm();
    }
    let center = free.center();
    let shift = now.moment / now.mass - was.moment / was.mass;
    let wanted = was.spin + shift.cross(&was.momentum);
    let missing = wanted - now.spin - center.cross(&(along * free.mass));
    let turn = turn(heirs, center, &free, missing, limit);
    for heir in heirs.iter().filter(|heir| heir.is_free) {
        let to = velocity(velocities, heir) + along + turn.cross(&(heir.at - center));
        velocities[heir.vertex.index()] = rounded(to);
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed velocity is rounded once to storage"
)]
fn rounded(v: Vec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}

/// The angular velocity that gives the free heirs `missing` angular momentum about their center. About
/// every axis nobody gets faster than `limit`.
fn turn(heirs: &[Heir], center: Vec3, free: &Spread, missing: Vec3, limit: f64) -> Vec3 {
    let Some(axes) = axes(free.central()) else {
        return Vec3::zeros();
    };
    // Inertia and the farthest vertex of every axis.
    let mut arms = [(0.0_f64, 0.0_f64); 3];
    for heir in heirs.iter().filter(|heir| heir.is_free) {
        let r = heir.at - center;
        for (arm, (axis, _)) in arms.iter_mut().zip(&axes) {
            let squared = axis.cross(&r).norm_squared();
            arm.0 += heir.mass * squared;
            arm.1 = arm.1.max(squared);
        }
    }
    let least = (THIN * center.norm()).powi(2);
    let farthest = arms.iter().fold(least, |far, arm| far.max(arm.1));
    let mut turn = Vec3::zeros();
    for ((axis, _), (inertia, squared)) in axes.iter().zip(arms) {
        let (rate, most) = (missing.dot(axis) / inertia, limit / squared.sqrt());
        if squared > THIN * THIN * farthest && rate.is_finite() {
            turn += axis * rate.clamp(-most, most);
        }
    }
    turn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heirs at corners of a skew lattice over the first so many of three directions.
    fn heirs(directions: usize) -> Vec<Heir> {
        let directions = &[[0.7, 0.2, 0.1], [-0.1, 0.3, 0.9], [0.2, -0.8, 0.3]][..directions];
        let heir = |i: u32| {
            let steps = (0..).zip(directions).map(|(k, d)| {
                let step = f64::from((i / 3_u32.pow(k)) % 3) * 1.1;
                Vec3::from(*d) * step
            });
            Heir {
                vertex: VertexId(i),
                at: Vec3::new(0.3, -0.4, 5.0) + steps.sum::<Vec3>(),
                mass: 0.1 + f64::from((i * 7) % 5) * 0.05,
                is_free: true,
            }
        };
        (0..3_u32.pow(u32::try_from(directions.len()).unwrap()))
            .map(heir)
            .collect()
    }

    fn sums(heirs: &[Heir]) -> Spread {
        let mut spread = Spread::default();
        heirs.iter().for_each(|heir| spread.add(heir.mass, heir.at));
        spread
    }

    #[test]
    fn heirs_on_a_point_a_line_a_plane_and_in_space_keep_mass_and_center() {
        for directions in 0..4 {
            let mut heirs = heirs(directions);
            let before = sums(&heirs);
            // Somewhere between them.
            let all: Vec3 = heirs.iter().map(|heir| heir.at).sum();
            let center = before.center() * 0.6 + all / heirs.len() as f64 * 0.4;
            keep_center(&mut heirs, center * before.mass);
            let after = sums(&heirs);
            assert!((after.mass - before.mass).abs() < 1e-9, "{directions}");
            assert!((after.center() - center).norm() < 1e-9, "{directions}");
            assert!(heirs.iter().all(|heir| heir.mass > 0.0), "{directions}");
        }
    }

    #[test]
    fn heirs_turn_about_the_axes_that_they_have() {
        for directions in 0..4 {
            let heirs = heirs(directions);
            let mut velocities = vec![[0.0; 4]; heirs.len()];
            let shape = sums(&heirs);
            let (momentum, about) = (Vec3::new(2.0, -1.0, 0.5), Vec3::new(0.01, -0.02, 0.03));
            let was = Carried {
                mass: shape.mass,
                moment: shape.moment,
                momentum,
                spin: shape.center().cross(&momentum) + about,
                fastest: 10.0,
            };
            keep_momentum(&heirs, &mut velocities, &was);
            let (mut sum, mut spin) = (Vec3::zeros(), Vec3::zeros());
            for heir in &heirs {
                let [x, y, z, _] = velocities[heir.vertex.index()].map(f64::from);
                let momentum = Vec3::new(x, y, z) * heir.mass;
                sum += momentum;
                spin += (heir.at - shape.center()).cross(&momentum);
            }
            assert!((sum - momentum).norm() < 1e-5, "{directions}: {sum}");
            let expected = match directions {
                0 => Vec3::zeros(),
                1 => {
                    let line = Vec3::new(0.7, 0.2, 0.1).normalize();
                    about - line * line.dot(&about)
                }
                _ => about,
            };
            assert!((spin - expected).norm() < 1e-5, "{directions}: {spin}");
        }
    }
}
