//! A fingerprint of all edits of a surface, by which an undo recognizes it.

/// The kinds of edit, mixed into the fingerprint.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Step {
    Build,
    AddVertex,
    AddTriangle,
    RemoveTriangle,
    RemoveVertex,
    SetCorner,
    Join,
    OpenEdge,
    SetPiece,
    SetMaterial,
    SetUv,
    SetNormal,
    SetRow,
    NewPiece,
    Finish,
}

/// A hash of the construction and of every edit since, in order.
///
/// Equal hashes mean equal connectivity, pieces and slots; motion does not count. An undo compares
/// and restores it. It does not depend on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct History(u64);

impl History {
    /// Returns the fingerprint.
    pub(crate) fn value(self) -> u64 {
        self.0
    }

    /// Mixes in an edit of the element `id`.
    pub(crate) fn step(&mut self, step: Step, id: u32) {
        self.word(((step as u64) << 32) | u64::from(id));
    }

    /// Mixes in two numbers of an edit.
    pub(crate) fn pair(&mut self, a: u32, b: u32) {
        self.word((u64::from(a) << 32) | u64::from(b));
    }

    /// Mixes in the bits of floats.
    pub(crate) fn floats(&mut self, values: &[f32]) {
        for pair in values.chunks(2) {
            let bits = |i: usize| pair.get(i).map_or(0, |value| value.to_bits());
            self.pair(bits(0), bits(1));
        }
    }

    /// Mixes in a word, bijectively for a given state, with the factors of `SplitMix64`.
    pub(crate) fn word(&mut self, word: u64) {
        let x = (self.0 ^ word)
            .wrapping_add(0x9e37_79b9_7f4a_7c15)
            .wrapping_mul(0xbf58_476d_1ce4_e5b9);
        self.0 = x ^ (x >> 31);
    }
}
