//! Compares the order of calls in `whole_body.wgsl` with the order of passes in a [`StepPlan`].

use super::*;
use crate::constraints::batches::{BendingSet, StretchSet};
use crate::constraints::coloring::LAYERS;
use crate::constraints::edges::EdgeId;
use crate::gpu::layout::{CONTACT_FEATURES, CONTACT_RECOVERIES, CONTACTS};
use crate::step::pass::{ConstraintKind, Pass};
use crate::step::plan::{PlanKey, StepPlan};
use incise_mesh::VertexId;
use naga::{Block, Constant, Function, Statement};

/// A token of the order: the name of a pass, or the braces of a loop.
type Tokens = Vec<String>;

const PREDICT: &str = "predict";
const PINS: &str = "pins";
const RESET: &str = "reset multipliers";
const ATTACHMENTS: &str = "long-range attachments";
const VOLUMES: &str = "volumes";
const COLLIDERS: &str = "colliders";
const INTEGRATE: &str = "integrate";

fn project(kind: u32) -> String {
    format!("project kind {kind}")
}

fn back(kind: u32) -> String {
    format!("project kind {kind} back")
}

/// Returns the token of a function that the shader calls, or none for other functions.
fn token(call: &str, kind: Option<u32>) -> Option<String> {
    Some(match call {
        "predict_body" => PREDICT.to_owned(),
        "move_pin" => PINS.to_owned(),
        "reset_kind" => RESET.to_owned(),
        "pull_to_anchor" => ATTACHMENTS.to_owned(),
        "project_kind" => project(kind.expect("the kind is a constant")),
        "project_back" => back(kind.expect("the kind is a constant")),
        "project_volumes" => VOLUMES.to_owned(),
        "push_all_out" => COLLIDERS.to_owned(),
        "integrate_vertex" => INTEGRATE.to_owned(),
        _ => return None,
    })
}

/// Appends the calls of a block and the loops around them, in order.
fn walk(module: &Module, function: &Function, block: &Block, tokens: &mut Tokens) {
    for statement in block {
        match statement {
            Statement::Call {
                function: callee,
                arguments,
                ..
            } => {
                let name = module.functions[*callee].name.as_deref().unwrap_or("");
                let constant = |at| match function.expressions[at] {
                    Expression::Constant(constant) => {
                        let Constant { init, .. } = module.constants[constant];
                        match module.global_expressions[init] {
                            Expression::Literal(Literal::U32(value)) => Some(value),
                            _ => None,
                        }
                    }
                    Expression::Literal(Literal::U32(value)) => Some(value),
                    _ => None,
                };
                let kind = arguments.get(1).copied().and_then(constant);
                tokens.extend(token(name, kind));
            }
            Statement::Block(block) => walk(module, function, block, tokens),
            Statement::If { accept, reject, .. } => {
                walk(module, function, accept, tokens);
                walk(module, function, reject, tokens);
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                let mut inner = Tokens::new();
                walk(module, function, body, &mut inner);
                walk(module, function, continuing, &mut inner);
                // A loop over lanes covers one pass; other loops repeat several.
                match inner.len() {
                    0 | 1 => tokens.append(&mut inner),
                    _ => enclose(tokens, inner),
                }
            }
            _ => {}
        }
    }
}

fn enclose(tokens: &mut Tokens, inner: Tokens) {
    tokens.push("{".to_owned());
    tokens.extend(inner);
    tokens.push("}".to_owned());
}

fn name(pass: Pass) -> String {
    match pass {
        Pass::Predict => PREDICT.to_owned(),
        Pass::Pins => PINS.to_owned(),
        Pass::ResetMultipliers => RESET.to_owned(),
        Pass::LongRangeAttachments => ATTACHMENTS.to_owned(),
        Pass::Project { kind, .. } => project(kind as u32),
        Pass::ProjectBack { kind, .. } => back(kind as u32),
        Pass::ContactFeatures => project(CONTACT_FEATURES),
        Pass::ContactsBeforeVolumes | Pass::Contacts => project(CONTACTS),
        Pass::ContactRecovery => project(CONTACT_RECOVERIES),
        Pass::Volumes => VOLUMES.to_owned(),
        Pass::CollidersBeforeVolumes | Pass::Colliders => COLLIDERS.to_owned(),
        Pass::Integrate => INTEGRATE.to_owned(),
        Pass::SolidSupports | Pass::Cells(_) | Pass::SolidPins => {
            unreachable!("not in plans for GPUs")
        }
    }
}

fn names(passes: &[Pass]) -> Tokens {
    let mut names: Tokens = passes.iter().copied().map(name).collect();
    names.dedup();
    names
}

/// Returns a plan with every pass, and batches in every layer.
fn full_plan() -> StepPlan {
    let mut stretch = StretchSet::with_layers(100, LAYERS);
    let mut bending = BendingSet::with_layers(100, LAYERS);
    let mut springs = StretchSet::with_layers(100, 1);
    for layer in 0..LAYERS {
        for i in 1..70 {
            let wings = [0, i, i + 10, i + 20].map(VertexId);
            stretch.insert_in(layer, [VertexId(0), VertexId(i)], 1.0, EdgeId::TEST);
            bending.insert_in(layer, wings, 0.0, EdgeId::TEST);
        }
    }
    springs.insert([VertexId(0), VertexId(1)], 1.0);
    let key = PlanKey {
        iterations: 2,
        contact_rounds: 2,
        pins: true,
        attachments: true,
        volumes: true,
        contacts: true,
        colliders: true,
        multipliers: true,
    };
    let mut plan = StepPlan::default();
    plan.update(key, &stretch, Some(&bending), Some(&springs), None);
    plan
}

/// Returns the order of a plan, its layers as a loop.
fn tokens_of(plan: &StepPlan) -> Tokens {
    let layer = |pass: &Pass| match pass.kind_and_layer() {
        Some((kind, layer)) if kind != ConstraintKind::InteriorSpring => {
            Some((pass.is_back(), layer))
        }
        _ => None,
    };
    let mut iteration = Tokens::new();
    let mut last = None;
    for run in plan.iteration().chunk_by(|a, b| layer(a) == layer(b)) {
        let way = layer(&run[0]);
        match way.zip(last) {
            // The loop of this way has the layer already.
            Some(((is_back, _), (last_way, ref first))) if is_back == last_way => {
                assert_eq!(names(run), *first, "layers are alike");
            }
            _ if way.is_none() => iteration.extend(names(run)),
            _ => enclose(&mut iteration, names(run)),
        }
        last = way.map(|(is_back, _)| (is_back, names(run)));
    }
    let round = names(plan.contact_round());
    iteration.truncate(iteration.len() - round.len());
    enclose(&mut iteration, round);
    let mut substep = names(plan.prologue());
    enclose(&mut substep, iteration);
    substep.extend(names(plan.epilogue()));
    let mut frame = Tokens::new();
    enclose(&mut frame, substep);
    frame
}

#[test]
fn the_whole_body_shader_follows_the_plan() {
    let [_, module, _] = modules();
    let function = &module.entry_points[0].function;
    let mut found = Tokens::new();
    walk(&module, function, &function.body, &mut found);
    found.dedup_by(|a, b| a == b && a == RESET);
    assert_eq!(found, tokens_of(&full_plan()));
}
