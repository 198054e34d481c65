//! A fingerprint of all edits that a surface has seen.

/// The first word of what an edit notes: which edit it was.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Step {
    Build,
    AddVertex,
    AddTriangle,
    RemoveTriangle,
    RemoveVertex,
    SetCorner,
    Join,
    SetPiece,
    SetMaterial,
    SetUv,
    SetNormal,
    NewPiece,
    Finish,
}

/// A fingerprint of the start and of every edit since, in order. Two surfaces of the same history
/// have the same connectivity, pieces and slots; an undo knows by it whether it still fits. Motion
/// does not count. It is data of the surface like any other: the same edits give the same number on
/// every machine, and an undo puts the old one back.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct History(u64);

impl History {
    /// The fingerprint.
    pub(crate) fn value(self) -> u64 {
        self.0
    }

    /// Notes an edit of the element `id`.
    pub(crate) fn step(&mut self, step: Step, id: u32) {
        self.word(((step as u64) << 32) | u64::from(id));
    }

    /// Notes two numbers that belong to an edit.
    pub(crate) fn pair(&mut self, a: u32, b: u32) {
        self.word((u64::from(a) << 32) | u64::from(b));
    }

    /// Notes the bits of floats.
    pub(crate) fn floats(&mut self, values: &[f32]) {
        for value in values {
            self.word(u64::from(value.to_bits()));
        }
    }

    /// One to one in the word for a given state and the other way around, so that histories part at
    /// the first difference and meet again by chance only. The factors are those of `SplitMix64`.
    fn word(&mut self, word: u64) {
        let x = (self.0 ^ word)
            .wrapping_add(0x9e37_79b9_7f4a_7c15)
            .wrapping_mul(0xbf58_476d_1ce4_e5b9);
        self.0 = x ^ (x >> 31);
    }
}
