//! The keyboard shortcuts: one table for the event handler and for the help.

use crate::pointer::Tool;

/// An action of a key or of a panel button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Selects the tool of the left mouse button.
    SelectTool(Tool),
    /// Pauses or resumes the simulation.
    Pause,
    /// Steps one frame and pauses.
    Step,
    /// Restores the body of the start.
    Reset,
    /// Undoes the last cut.
    Undo,
    /// Repeats the last undone cut.
    Redo,
    /// Unpins all vertices.
    Unpin,
    /// Fits the whole body in the view.
    Fit,
    /// Toggles the wireframe.
    Wireframe,
    /// Toggles a color for each piece.
    PieceColors,
    /// Toggles the color of cut sections.
    CapColors,
    /// Toggles stretch constraints in the colors of their batches.
    BatchColors,
    /// Selects the next coarser refinement level.
    Coarser,
    /// Selects the next finer refinement level.
    Finer,
    /// Removes one substep.
    FewerSubsteps,
    /// Adds one substep.
    MoreSubsteps,
    /// Saves each piece to a file.
    Save,
    /// Saves the recording.
    SaveRecording,
    /// Toggles the panel.
    Panel,
    /// Toggles the help.
    Help,
    /// Closes the window.
    Quit,
}

/// A key, its action, and its description in the help.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Character, or name of the key.
    pub name: &'static str,
    /// Action of the key.
    pub action: Action,
    /// Description in the help.
    pub description: &'static str,
}

const fn key(name: &'static str, action: Action, description: &'static str) -> Key {
    Key {
        name,
        action,
        description,
    }
}

/// All keys, in the order of the help.
pub const KEYS: [Key; 25] = [
    key(
        "1",
        Action::SelectTool(Tool::Slice),
        "slice: draw a line across the body",
    ),
    key(
        "2",
        Action::SelectTool(Tool::Blade),
        "blade: drag it into or through the body",
    ),
    key("3", Action::SelectTool(Tool::Grab), "grab: drag a vertex"),
    key("4", Action::SelectTool(Tool::Pin), "pin or unpin a vertex"),
    key(
        "5",
        Action::SelectTool(Tool::Orbit),
        "orbit: rotate the view",
    ),
    key("Space", Action::Pause, "pause or resume"),
    key(".", Action::Step, "step one frame"),
    key("r", Action::Reset, "reset"),
    key("z", Action::Undo, "undo the last cut"),
    key("y", Action::Redo, "redo the last cut"),
    key("u", Action::Unpin, "remove all pins"),
    key("f", Action::Fit, "fit the body in the view"),
    key("w", Action::Wireframe, "wireframe"),
    key("p", Action::PieceColors, "color by piece"),
    key("c", Action::CapColors, "color cut sections"),
    key("b", Action::BatchColors, "color constraints by batch"),
    key("[", Action::Coarser, "coarser cut sections"),
    key("]", Action::Finer, "finer cut sections"),
    key("-", Action::FewerSubsteps, "fewer substeps"),
    key("+", Action::MoreSubsteps, "more substeps"),
    key("s", Action::Save, "save the pieces"),
    key("o", Action::SaveRecording, "save the recording"),
    key("h", Action::Panel, "show or hide the panel"),
    key("?", Action::Help, "show or hide this help"),
    key("q", Action::Quit, "quit"),
];

/// Mouse buttons and their description in the help.
pub const MOUSE: [(&str, &str); 5] = [
    ("left", "use the selected tool"),
    (
        "Shift and left",
        "slice: extend the line across the whole body",
    ),
    ("right", "rotate the view"),
    ("middle", "pan the view"),
    ("wheel", "zoom"),
];

/// Returns the action of a key by its name, ignoring case.
#[must_use]
pub fn action_for_key(name: &str) -> Option<Action> {
    let known = KEYS.iter().find(|key| key.name.eq_ignore_ascii_case(name));
    known.map(|key| key.action)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_actions_are_unique() {
        for (i, a) in KEYS.iter().enumerate() {
            for b in &KEYS[i + 1..] {
                assert!(!a.name.eq_ignore_ascii_case(b.name), "{}", a.name);
                assert_ne!(a.action, b.action, "{} and {}", a.name, b.name);
            }
            assert_eq!(action_for_key(a.name), Some(a.action));
        }
        assert_eq!(action_for_key("W"), Some(Action::Wireframe));
        assert_eq!(action_for_key("F12"), None);
    }
}
