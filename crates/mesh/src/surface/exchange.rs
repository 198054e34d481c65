//! Exchanges positions and rest positions, for edits in the rest shape.

use super::Surface;

impl Surface {
    /// Runs a function on the surface with positions and rest positions exchanged. O(n).
    ///
    /// Inverse masses stay. An edit by the function places new vertices in the rest shape and
    /// interpolates their positions. For its undo,
    /// [`Undo::exchange_shapes`](crate::Undo::exchange_shapes) must follow. The function must not
    /// move vertices.
    pub fn with_shapes_exchanged<R>(&mut self, run: impl FnOnce(&mut Self) -> R) -> R {
        let motion = self.motion;
        self.exchange_shapes();
        let result = run(self);
        self.exchange_shapes();
        self.motion = motion;
        result
    }

    fn exchange_shapes(&mut self) {
        for (position, rest) in self.positions.iter_mut().zip(&mut self.rest) {
            exchange(position, rest);
        }
    }
}

/// Exchanges the coordinates of a position and of a rest position.
pub(crate) fn exchange(position: &mut [f32; 4], rest: &mut [f32; 3]) {
    let [x, y, z, w] = *position;
    let [u, v, t] = std::mem::replace(rest, [x, y, z]);
    *position = [u, v, t, w];
}
