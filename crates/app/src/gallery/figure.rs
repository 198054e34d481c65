//! A figure as data: rows of panels, and the facts that the index lists.

use super::slice::place;
use crate::failure::Failure;
use incise_cut::CutError;
use incise_mesh::{Surface, TopologyError, TriangleId};
use incise_paper::PaperError;
use incise_render::{Camera, Color, Line, OverlayTriangle};
use incise_scene::SceneError;
use serde::Serialize;
use std::rc::Rc;

pub(super) const BODY: Color = Color::rgb(154, 174, 198);
pub(super) const CAP: Color = Color::rgb(222, 92, 66);
pub(super) const HIT: Color = Color::rgb(240, 176, 70);
pub(super) const NEW: Color = Color::rgb(104, 190, 172);
pub(super) const EDGE: Color = Color::rgb(24, 64, 214);
pub(super) const POINT: Color = Color::rgb(214, 24, 32);
pub(super) const SWEEP: Color = Color::rgb(70, 130, 210);

/// The reason that a figure cannot be made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FigureError {
    /// A model cannot be cut.
    #[error(transparent)]
    Cut(#[from] CutError),
    /// A model cannot be cut by the paper's method.
    #[error(transparent)]
    Paper(#[from] PaperError),
    /// Triangles do not form a surface.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A body cannot be moved.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl FigureError {
    /// Returns the failure of the figure with this name.
    pub(super) fn in_figure(self, figure: &'static str) -> Failure {
        Failure::Figure {
            figure,
            source: self,
        }
    }
}

/// A row of panels with a title.
pub(super) struct Row {
    pub(super) title: String,
    pub(super) panels: Vec<Panel>,
}

/// One image of a figure.
pub(super) struct Panel {
    pub(super) label: String,
    pub(super) camera: Camera,
    pub(super) shown: Vec<Rc<ColoredSurface>>,
    pub(super) sheets: Vec<OverlayTriangle>,
    pub(super) lines: Vec<Line>,
    /// Marked points \[m\].
    pub(super) points: Vec<[f32; 3]>,
    pub(super) facts: Facts,
}

/// A surface with a color for each visible triangle.
pub(super) struct ColoredSurface {
    pub(super) surface: Surface,
    colors: Vec<Option<Color>>,
    /// Squares of a checkerboard per unit of texture coordinates; 0 for none.
    pub(super) checkers: f32,
}

/// The facts of a panel in the index.
#[derive(Clone, Default, Serialize)]
pub(super) struct Facts {
    pub(super) model: Option<&'static str>,
    pub(super) method: Option<&'static str>,
    pub(super) level: Option<String>,
    /// Planes of successive cuts: `nx x + ny y + nz z = d`.
    pub(super) planes: Vec<[f64; 4]>,
    /// Whether the half in front of the plane is hidden.
    pub(super) second_half_removed: bool,
    /// Visible triangles.
    pub(super) triangles: usize,
    /// Visible triangles of caps.
    pub(super) cap_triangles: usize,
}

impl ColoredSurface {
    /// Colors a surface; triangles without a color are hidden.
    pub(super) fn new(
        surface: Surface,
        color: impl Fn(&Surface, TriangleId) -> Option<Color>,
    ) -> Rc<Self> {
        let mut colors = vec![None; surface.topology().triangle_slots()];
        for t in surface.topology().triangles() {
            colors[t.index()] = color(&surface, t);
        }
        Rc::new(Self {
            surface,
            colors,
            checkers: 0.0,
        })
    }

    /// Returns the surface with a checkerboard on its texture coordinates.
    pub(super) fn with_checkers(self: &Rc<Self>, squares: f32) -> Rc<Self> {
        Rc::new(Self {
            surface: self.surface.clone(),
            colors: self.colors.clone(),
            checkers: squares,
        })
    }

    pub(super) fn color(&self, t: TriangleId) -> Option<Color> {
        self.colors[t.index()]
    }

    /// Returns the number of visible triangles.
    pub(super) fn count(&self) -> usize {
        self.colors.iter().flatten().count()
    }

    /// Returns the number of visible cap triangles.
    pub(super) fn caps(&self) -> usize {
        let colors = self.colors.iter().flatten();
        colors.filter(|&&color| color == CAP).count()
    }

    /// Returns the corners of visible triangles \[m\].
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
    /// Creates a panel of surfaces and counts their triangles.
    pub(super) fn from_surfaces(
        label: String,
        camera: Camera,
        shown: Vec<Rc<ColoredSurface>>,
        facts: Facts,
    ) -> Self {
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

/// Returns the letter of a panel, a for the first.
pub(super) fn letter(i: usize) -> char {
    let letters = ('a'..='z').nth(i);
    letters.unwrap_or('-')
}
