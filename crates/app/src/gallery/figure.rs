//! What a figure is made of: rows of panels, and what an index tells of each.

use super::slice::place;
use crate::failure::Failure;
use incise_cut::CutError;
use incise_mesh::{Surface, TopologyError, TriangleId};
use incise_refine::RefineError;
use incise_render::{Camera, Color, Line, Sheet};
use serde::Serialize;
use std::rc::Rc;

pub(super) const BODY: Color = Color::rgb(154, 174, 198);
pub(super) const CAP: Color = Color::rgb(222, 92, 66);
pub(super) const HIT: Color = Color::rgb(240, 176, 70);
pub(super) const NEW: Color = Color::rgb(104, 190, 172);
pub(super) const EDGE: Color = Color::rgb(24, 64, 214);
pub(super) const POINT: Color = Color::rgb(214, 24, 32);
pub(super) const SWEEP: Color = Color::rgb(70, 130, 210);

/// Why a figure cannot be made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FigureError {
    /// A model is not cut.
    #[error(transparent)]
    Cut(#[from] CutError),
    /// A hole is not covered.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// Triangles are no surface.
    #[error(transparent)]
    Topology(#[from] TopologyError),
}

impl FigureError {
    /// The failure of the figure with this name.
    pub(super) fn of(self, figure: &'static str) -> Failure {
        Failure::Figure {
            figure,
            source: self,
        }
    }
}

/// A row of panels, with a text above it.
pub(super) struct Row {
    pub(super) title: String,
    pub(super) panels: Vec<Panel>,
}

/// One picture of a figure.
pub(super) struct Panel {
    pub(super) label: String,
    pub(super) camera: Camera,
    pub(super) shown: Vec<Rc<Shown>>,
    pub(super) sheets: Vec<Sheet>,
    pub(super) lines: Vec<Line>,
    /// Points that are marked \[m\].
    pub(super) points: Vec<[f32; 3]>,
    pub(super) facts: Facts,
}

/// A surface and the color of each of its triangles, by their ids; none of those that are not shown.
pub(super) struct Shown {
    pub(super) surface: Surface,
    colors: Vec<Option<Color>>,
}

/// What the index tells of a panel.
#[derive(Clone, Default, Serialize)]
pub(super) struct Facts {
    pub(super) model: Option<&'static str>,
    pub(super) method: Option<&'static str>,
    pub(super) level: Option<String>,
    /// Planes that the model is cut along, one after the other: `nx x + ny y + nz z = d`.
    pub(super) planes: Vec<[f64; 4]>,
    /// Whether what is in front of the plane was left out.
    pub(super) second_half_removed: bool,
    /// Triangles in the picture.
    pub(super) triangles: usize,
    /// Those of caps among them.
    pub(super) cap_triangles: usize,
}

impl Shown {
    /// A surface in these colors.
    pub(super) fn new(
        surface: Surface,
        color: impl Fn(&Surface, TriangleId) -> Option<Color>,
    ) -> Rc<Self> {
        let mut colors = vec![None; surface.topology().triangle_slots()];
        for t in surface.topology().triangles() {
            colors[t.index()] = color(&surface, t);
        }
        Rc::new(Self { surface, colors })
    }

    pub(super) fn color(&self, t: TriangleId) -> Option<Color> {
        self.colors[t.index()]
    }

    /// Triangles that are shown.
    pub(super) fn count(&self) -> usize {
        self.colors.iter().flatten().count()
    }

    /// Those of them that are caps.
    pub(super) fn caps(&self) -> usize {
        let colors = self.colors.iter().flatten();
        colors.filter(|&&color| color == CAP).count()
    }

    /// Corners of triangles that are shown \[m\].
    pub(super) fn corners(&self) -> impl Iterator<Item = [f32; 3]> {
        let topology = self.surface.topology();
        let shown = topology
            .triangles()
            .filter(|&t| self.color(t).is_some())
            .flat_map(|t| topology.triangle(t));
        shown.map(|v| place(&self.surface, v))
    }
}

impl Panel {
    /// A panel of surfaces alone; the facts' numbers of triangles are theirs.
    pub(super) fn of(label: String, camera: Camera, shown: Vec<Rc<Shown>>, facts: Facts) -> Self {
        let facts = Facts {
            triangles: shown.iter().map(|shown| shown.count()).sum(),
            cap_triangles: shown.iter().map(|shown| shown.caps()).sum(),
            ..facts
        };
        Self {
            label,
            camera,
            shown,
            sheets: Vec::new(),
            lines: Vec::new(),
            points: Vec::new(),
            facts,
        }
    }
}

/// The letter that panels are known by: (a) for the first.
pub(super) fn letter(i: usize) -> char {
    let letters = ('a'..='z').nth(i);
    letters.unwrap_or('-')
}
