//! The keyboard: one table, which both who presses a key and who asks for help read.

use crate::pointer::Tool;

/// What a key or a button does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// The left button does this from now on.
    Take(Tool),
    /// Stops or goes on.
    Pause,
    /// One frame.
    Step,
    /// The body as it was at first.
    Reset,
    /// Takes a cut back.
    Undo,
    /// Does it again.
    Redo,
    /// Lets all pins go.
    Unpin,
    /// The whole body in the picture.
    Fit,
    /// Edges of triangles.
    Wireframe,
    /// A color for every piece.
    PieceColors,
    /// A color for caps.
    CapColors,
    /// Edges in the colors of their batches.
    Batches,
    /// How cuts open the mesh: exactly, or the paper's way.
    Method,
    /// A level coarser.
    Coarser,
    /// A level finer.
    Finer,
    /// One substep less.
    FewerSubsteps,
    /// One substep more.
    MoreSubsteps,
    /// The pieces as files.
    Save,
    /// The recording as a file.
    SaveRecording,
    /// The panel.
    Panel,
    /// The keys.
    Help,
    /// The end.
    Quit,
}

/// A key with its action and what to say of it.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// What the keyboard says: a character, or a key's name.
    pub name: &'static str,
    /// What it does.
    pub action: Action,
    /// What to say of it.
    pub about: &'static str,
}

const fn key(name: &'static str, action: Action, about: &'static str) -> Key {
    Key {
        name,
        action,
        about,
    }
}

/// All keys, in the order in which they are shown.
pub const KEYS: [Key; 26] = [
    key(
        "1",
        Action::Take(Tool::Slice),
        "slice: drag a line across the body",
    ),
    key(
        "2",
        Action::Take(Tool::Blade),
        "blade: hold and move it through the body",
    ),
    key("3", Action::Take(Tool::Grab), "grab: pull a vertex"),
    key("4", Action::Take(Tool::Pin), "pin a vertex, or let it go"),
    key("5", Action::Take(Tool::Orbit), "turn the view"),
    key("Space", Action::Pause, "pause, go on"),
    key(".", Action::Step, "one frame"),
    key("r", Action::Reset, "reset"),
    key("z", Action::Undo, "undo a cut"),
    key("y", Action::Redo, "redo it"),
    key("u", Action::Unpin, "let all pins go"),
    key("f", Action::Fit, "the whole body in the picture"),
    key("w", Action::Wireframe, "edges of triangles"),
    key("p", Action::PieceColors, "a color for every piece"),
    key("c", Action::CapColors, "a color for caps"),
    key(
        "b",
        Action::Batches,
        "constraints in the colors of their batches",
    ),
    key("m", Action::Method, "method: exact or the paper's"),
    key("[", Action::Coarser, "coarser caps"),
    key("]", Action::Finer, "finer caps"),
    key("-", Action::FewerSubsteps, "a substep less"),
    key("+", Action::MoreSubsteps, "a substep more"),
    key("s", Action::Save, "save the pieces"),
    key("o", Action::SaveRecording, "save the recording"),
    key("h", Action::Panel, "panel"),
    key("?", Action::Help, "keys"),
    key("q", Action::Quit, "quit"),
];

/// What the mouse does, beside the tool on its left button.
pub const MOUSE: [(&str, &str); 5] = [
    ("left", "the tool"),
    ("Shift and left", "slice: as far as the body goes"),
    ("right", "turn the view"),
    ("middle", "move the view"),
    ("wheel", "nearer, farther"),
];

/// The action of a key by its name, in any case.
#[must_use]
pub fn action_of(name: &str) -> Option<Action> {
    let known = KEYS.iter().find(|key| key.name.eq_ignore_ascii_case(name));
    known.map(|key| key.action)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_and_no_action_is_there_twice() {
        for (i, a) in KEYS.iter().enumerate() {
            for b in &KEYS[i + 1..] {
                assert!(!a.name.eq_ignore_ascii_case(b.name), "{}", a.name);
                assert_ne!(a.action, b.action, "{} and {}", a.name, b.name);
            }
            assert_eq!(action_of(a.name), Some(a.action));
        }
        assert_eq!(action_of("W"), Some(Action::Wireframe));
        assert_eq!(action_of("F12"), None);
    }
}
