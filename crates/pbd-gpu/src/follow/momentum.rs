//! Adjusts masses and velocities of vertices to given sums.
//!
//! The sums are mass, center of mass, momentum and angular momentum of the vertices that an edit
//! affects.

use incise_mesh::{Vec3, VertexId};
use nalgebra::{Matrix3, SymmetricEigen};

/// Maximum number of rounds of [`keep_center`]. A round changes a mass by at most three quarters.
const MAX_ROUNDS: usize = 8;

/// Maximum relative change of a mass per round and axis.
const MAX_TILT: f64 = 0.25;

/// Maximum velocity correction along, or about one axis, relative to the highest speed before.
const MAX_SPEED_RATIO: f64 = 4.0;

/// Relative extent of vertices below which they count as a plane, a line or a point.
const FLATNESS: f64 = 1e-6;

/// Sums over vertices about a point of reference.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Momentum {
    /// \[kg\]
    pub(crate) mass: f64,
    /// Sum of mass times position [kg m].
    pub(crate) first_moment: Vec3,
    /// [kg m/s]
    pub(crate) linear: Vec3,
    /// [kg m^2/s]
    pub(crate) angular: Vec3,
    /// Highest speed of a vertex [m/s].
    pub(crate) max_speed: f64,
}

impl Momentum {
    /// Returns the sums of one vertex.
    pub(crate) fn new(mass: f64, position: Vec3, velocity: Vec3) -> Self {
        let linear = velocity * mass;
        Self {
            mass,
            first_moment: position * mass,
            linear,
            angular: position.cross(&linear),
            max_speed: velocity.norm(),
        }
    }

    /// Adds a fraction of other sums.
    pub(crate) fn add(&mut self, other: &Self, fraction: f64) {
        self.mass += other.mass * fraction;
        self.first_moment += other.first_moment * fraction;
        self.linear += other.linear * fraction;
        self.angular += other.angular * fraction;
        self.max_speed = self.max_speed.max(other.max_speed);
    }
}

/// A vertex that receives mass and momentum.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recipient {
    pub(crate) vertex: VertexId,
    /// Position relative to the point of reference \[m\].
    pub(crate) position: Vec3,
    /// \[kg\]
    pub(crate) mass: f64,
    /// True if the vertex is not pinned.
    pub(crate) is_free: bool,
}

/// Moments of a mass distribution.
#[derive(Debug, Clone, Copy, Default)]
struct MassMoments {
    mass: f64,
    first: Vec3,
    /// Sum of mass times the outer product of the position with itself.
    second: Matrix3<f64>,
}

impl MassMoments {
    fn add(&mut self, mass: f64, position: Vec3) {
        let first = position * mass;
        self.mass += mass;
        self.first += first;
        self.second += first * position.transpose();
    }

    fn center(&self) -> Vec3 {
        self.first / self.mass
    }

    /// Returns the second moment about the center.
    fn central(&self) -> Matrix3<f64> {
        self.second - self.first * self.center().transpose()
    }
}

/// Returns eigenvectors and eigenvalues of a second moment, or `None` if it is not finite.
fn axes(second: Matrix3<f64>) -> Option<[(Vec3, f64); 3]> {
    let eigen = SymmetricEigen::try_new(second, f64::EPSILON, 64)?;
    let axis = |k: usize| {
        (
            eigen.eigenvectors.column(k).into_owned(),
            eigen.eigenvalues[k],
        )
    };
    Some([0, 1, 2].map(axis))
}

/// Shifts mass between recipients so that their first moment becomes `first_moment`.
///
/// Otherwise a body in straight flight would have to spin after a cut to preserve its angular
/// momentum. Masses are multiplied by a linear function of position, with values of 1/4 to 7/4 in a
/// round. A center out of reach is only approached.
pub(crate) fn keep_center(recipients: &mut [Recipient], first_moment: Vec3) {
    let mut moments = MassMoments::default();
    for recipient in &*recipients {
        moments.add(recipient.mass, recipient.position);
    }
    for _ in 0..MAX_ROUNDS {
        let (center, error) = (moments.center(), first_moment - moments.first);
        let Some(axes) = axes(moments.central()) else {
            return;
        };
        let mut extents = [0.0_f64; 3];
        for recipient in &*recipients {
            for (extent, (axis, _)) in extents.iter_mut().zip(&axes) {
                *extent = extent.max((recipient.position - center).dot(axis).abs());
            }
        }
        let mut tilt = Vec3::zeros();
        let mut is_limited = false;
        let max_extent = extents.into_iter().fold(FLATNESS * center.norm(), f64::max);
        for ((axis, second), extent) in axes.into_iter().zip(extents) {
            let (limit, full) = (MAX_TILT / extent, error.dot(&axis) / second);
            if extent > FLATNESS * max_extent && full.is_finite() {
                tilt += axis * full.clamp(-limit, limit);
                is_limited |= full.abs() > limit;
            }
        }
        moments = MassMoments::default();
        for recipient in &mut *recipients {
            recipient.mass *= 1.0 + (recipient.position - center).dot(&tilt);
            moments.add(recipient.mass, recipient.position);
        }
        if !is_limited {
            return;
        }
    }
}

/// Adds a rigid motion to the free recipients so that the sums become those of `target`.
///
/// These are momentum and angular momentum about the center of mass; about any fixed point too if
/// the center is that of `target`.
///
/// Free recipients on a line do not turn about it, and a single one does not turn. A correction
/// along, or about one of three axes, is at most [`MAX_SPEED_RATIO`] times the highest speed in
/// `target`, which bounds the kinetic energy. Without pins twice that speed suffices along. More is
/// needed about an axis only if mass comes much closer to it.
pub(crate) fn keep_momentum(
    recipients: &[Recipient],
    velocities: &mut [[f32; 4]],
    target: &Momentum,
) {
    let velocity = |velocities: &[[f32; 4]], recipient: &Recipient| {
        let [x, y, z, _] = velocities[recipient.vertex.index()];
        Vec3::new(x.into(), y.into(), z.into())
    };
    let (mut now, mut free) = (Momentum::default(), MassMoments::default());
    for recipient in recipients {
        let Recipient { mass, position, .. } = *recipient;
        let one = Momentum::new(mass, position, velocity(velocities, recipient));
        now.add(&one, 1.0);
        if recipient.is_free {
            free.add(mass, position);
        }
    }
    if free.mass <= 0.0 {
        return;
    }
    let limit = MAX_SPEED_RATIO * target.max_speed;
    let mut translation = (target.linear - now.linear) / free.mass;
    if translation.norm() > limit {
        translation *= limit / translation.norm();
    }
    let center = free.center();
    let shift = now.first_moment / now.mass - target.first_moment / target.mass;
    let angular = target.angular + shift.cross(&target.linear);
    let missing = angular - now.angular - center.cross(&(translation * free.mass));
    let rotation = angular_velocity(recipients, center, &free, missing, limit);
    for recipient in recipients.iter().filter(|r| r.is_free) {
        let rigid = translation + rotation.cross(&(recipient.position - center));
        velocities[recipient.vertex.index()] = round(velocity(velocities, recipient) + rigid);
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed velocity is rounded once to storage"
)]
fn round(v: Vec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}

/// Returns the angular velocity that adds `missing` angular momentum about the center.
///
/// It is bounded so that no free recipient moves faster than `limit` about an axis.
fn angular_velocity(
    recipients: &[Recipient],
    center: Vec3,
    free: &MassMoments,
    missing: Vec3,
    limit: f64,
) -> Vec3 {
    let Some(axes) = axes(free.central()) else {
        return Vec3::zeros();
    };
    // Moment of inertia and largest squared distance, by axis.
    let mut arms = [(0.0_f64, 0.0_f64); 3];
    for recipient in recipients.iter().filter(|r| r.is_free) {
        let r = recipient.position - center;
        for (arm, (axis, _)) in arms.iter_mut().zip(&axes) {
            let squared = axis.cross(&r).norm_squared();
            arm.0 += recipient.mass * squared;
            arm.1 = arm.1.max(squared);
        }
    }
    let rounding = (FLATNESS * center.norm()).powi(2);
    let max_squared = arms.iter().fold(rounding, |max, arm| max.max(arm.1));
    let mut sum = Vec3::zeros();
    for ((axis, _), (inertia, squared)) in axes.iter().zip(arms) {
        let (rate, max_rate) = (missing.dot(axis) / inertia, limit / squared.sqrt());
        if squared > FLATNESS * FLATNESS * max_squared && rate.is_finite() {
            sum += axis * rate.clamp(-max_rate, max_rate);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns recipients on a skew lattice over the first `directions` of three directions.
    fn recipients(directions: usize) -> Vec<Recipient> {
        let directions = &[[0.7, 0.2, 0.1], [-0.1, 0.3, 0.9], [0.2, -0.8, 0.3]][..directions];
        let recipient = |i: u32| {
            let steps = (0..).zip(directions).map(|(k, d)| {
                let step = f64::from((i / 3_u32.pow(k)) % 3) * 1.1;
                Vec3::from(*d) * step
            });
            Recipient {
                vertex: VertexId(i),
                position: Vec3::new(0.3, -0.4, 5.0) + steps.sum::<Vec3>(),
                mass: 0.1 + f64::from((i * 7) % 5) * 0.05,
                is_free: true,
            }
        };
        (0..3_u32.pow(u32::try_from(directions.len()).unwrap()))
            .map(recipient)
            .collect()
    }

    fn moments(recipients: &[Recipient]) -> MassMoments {
        let mut moments = MassMoments::default();
        for recipient in recipients {
            moments.add(recipient.mass, recipient.position);
        }
        moments
    }

    #[test]
    fn mass_and_center_are_kept_in_any_number_of_dimensions() {
        for directions in 0..4 {
            let mut recipients = recipients(directions);
            let before = moments(&recipients);
            // A point in their convex hull.
            let all: Vec3 = recipients.iter().map(|r| r.position).sum();
            let center = before.center() * 0.6 + all / recipients.len() as f64 * 0.4;
            keep_center(&mut recipients, center * before.mass);
            let after = moments(&recipients);
            assert!((after.mass - before.mass).abs() < 1e-9, "{directions}");
            assert!((after.center() - center).norm() < 1e-9, "{directions}");
            assert!(recipients.iter().all(|r| r.mass > 0.0), "{directions}");
        }
    }

    #[test]
    fn angular_momentum_is_kept_about_the_axes_of_the_extent() {
        for directions in 0..4 {
            let recipients = recipients(directions);
            let mut velocities = vec![[0.0; 4]; recipients.len()];
            let shape = moments(&recipients);
            let (momentum, about) = (Vec3::new(2.0, -1.0, 0.5), Vec3::new(0.01, -0.02, 0.03));
            let target = Momentum {
                mass: shape.mass,
                first_moment: shape.first,
                linear: momentum,
                angular: shape.center().cross(&momentum) + about,
                max_speed: 10.0,
            };
            keep_momentum(&recipients, &mut velocities, &target);
            let (mut sum, mut spin) = (Vec3::zeros(), Vec3::zeros());
            for recipient in &recipients {
                let [x, y, z, _] = velocities[recipient.vertex.index()].map(f64::from);
                let momentum = Vec3::new(x, y, z) * recipient.mass;
                sum += momentum;
                spin += (recipient.position - shape.center()).cross(&momentum);
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
