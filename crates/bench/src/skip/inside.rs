//! What struts and contacts cost: nothing where there are none, and a stated part of everything else where there are.

use super::clock::pairs;
use super::row::Finding;
use super::{DT, Effort, Measurement, us};
use incise_cut::Sweep;
use incise_mesh::{Model, build_model};
use incise_pbd_gpu::{Collider, Material, SolverParams, Struts};
use incise_scene::{BodyId, ContactParams, Scene, SceneParams};
use std::error::Error;

/// What a scene has beyond the paper's.
#[derive(Debug, Clone, Copy, Default)]
struct Beyond {
    struts: Option<Struts>,
    contacts: Option<ContactParams>,
    /// Whether there is a collider far away.
    collider: bool,
    /// Whether the body is cut in two at first.
    cut: bool,
}

/// The table's body, moving as there.
fn scene(model: Model, beyond: Beyond) -> Result<(Scene, BodyId), Box<dyn Error>> {
    let mut scene = Scene::new(SceneParams {
        dt: DT,
        solver: SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::paper()
        },
        contacts: beyond.contacts,
        sleep: None,
        ..SceneParams::default()
    });
    let material = Material {
        struts: beyond.struts,
        ..crate::motion::material()
    };
    let body = scene.add_body(build_model(model), &material)?;
    if beyond.collider {
        scene.colliders.push(Collider::Sphere {
            center: [1e3; 3],
            radius: 1.0,
        });
    }
    if beyond.cut {
        let bounds = scene.body(body).surface().bounds();
        let middle = bounds.center();
        let sweep = Sweep::across_box([0.1, 1.0, 0.2], middle.y, &bounds)?;
        let [a, b, c, d] = sweep.corners();
        let blade = scene.add_blade([a, b]);
        scene.move_blade(blade, [d, c]);
        if scene.cut()?.cuts != 1 {
            return Err(format!("the blade missed {}", model.name()).into());
        }
        scene.jump_blade(blade, [a, b].map(|p| p.map(|c| c + 1e4)));
    }
    let (solver, surface) = scene.edit(body)?.solver_mut();
    crate::motion::start(solver, surface)?;
    Ok((scene, body))
}

/// A claim about a frame of one scene and that of another.
struct Claim {
    skip: &'static str,
    claim: &'static str,
    bound: f64,
    with: Beyond,
    without: Beyond,
}

/// Times two scenes in turns.
fn compare(model: Model, claim: &Claim, count: u32) -> Result<Finding, Box<dyn Error>> {
    let (mut with, _) = scene(model, claim.with)?;
    let (mut without, _) = scene(model, claim.without)?;
    let found = pairs(
        count,
        || Ok::<(), Box<dyn Error>>(with.step().map(|_| ())?),
        || Ok(without.step().map(|_| ())?),
    )?;
    let [one, other] = found.seconds.map(us);
    Ok(Finding {
        skip: claim.skip,
        claim: claim.claim,
        at: format!("{}: {one} of {other} us", model.name()),
        bound: claim.bound,
        measured: found.ratio,
    })
}

fn claims() -> [Claim; 5] {
    let nothing = Beyond::default();
    let none = Struts {
        density: 0.0,
        ..Struts::default()
    };
    let cut = Beyond {
        cut: true,
        ..nothing
    };
    let contacts = Some(ContactParams::default());
    [
        Claim {
            skip: "absent",
            claim: "time of a frame with struts of density 0, of that without any",
            bound: 1.02,
            with: Beyond {
                struts: Some(none),
                ..nothing
            },
            without: nothing,
        },
        Claim {
            skip: "absent",
            claim: "time of a frame with contacts and a far collider for a body in one piece, of that without",
            bound: 1.05,
            with: Beyond {
                contacts,
                collider: true,
                ..nothing
            },
            without: nothing,
        },
        Claim {
            skip: "struts",
            claim: "time of a frame with a strut a vertex, of that without",
            bound: 1.5,
            with: Beyond {
                struts: Some(Struts::default()),
                ..nothing
            },
            without: nothing,
        },
        Claim {
            skip: "contacts",
            claim: "time of a frame with the contacts of two halves, of that without",
            bound: 2.0,
            with: Beyond { contacts, ..cut },
            without: cut,
        },
        Claim {
            skip: "contacts",
            claim: "the same with folds that touch themselves",
            bound: 4.0,
            with: Beyond {
                contacts: Some(ContactParams {
                    own: true,
                    ..ContactParams::default()
                }),
                ..cut
            },
            without: cut,
        },
    ]
}

pub(super) fn measurements(effort: Effort) -> Vec<Measurement<'static>> {
    let of = |&model: &Model| {
        claims().map(|claim| {
            let skips: &'static [&'static str] = match claim.skip {
                "absent" => &["absent"],
                "struts" => &["struts"],
                _ => &["contacts"],
            };
            let name = format!("{}, {}", model.name(), claim.skip);
            Measurement::new(skips, name, move || {
                Ok([compare(model, &claim, effort.pairs)?])
            })
        })
    };
    effort.models.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_what_is_measured_and_nothing_else() {
        let [none, whole, struts, halves, own] = claims();
        let stats = |of: Beyond| {
            let (mut scene, body) = scene(Model::Sphere80, of).unwrap();
            let stats = *scene.step().unwrap();
            let projected = scene.body(body).solver().stats().strut_projections;
            (
                projected,
                stats.contact_searches,
                stats.contacts,
                stats.colliders,
            )
        };
        assert_eq!(stats(none.with), (0, 0, 0, 0));
        assert_eq!(stats(whole.with), (0, 0, 0, 0));
        assert!(stats(struts.with).0 > 0);
        for claim in [halves, own] {
            let (_, searches, contacts, _) = stats(claim.with);
            assert!(searches == 1 && contacts > 0);
            assert_eq!(stats(claim.without), (0, 0, 0, 0));
        }
    }
}
