//! [`verdicts`]: runs cases on one backend, side by side on the CPU.

use super::case::Case;
use super::energy;
use super::map::Cell;
use super::measured::groups;
use super::row::Row;
use super::runner::Runner;
use super::workers::side_by_side;
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

/// The verdicts of a group of cases, and the stability map if it has the case `map`.
type Verdicts = (Vec<Row>, Option<Vec<Cell>>);

/// Runs cases on the backend of a runner; calls `tick` with the verdicts of every group
/// when they are known.
///
/// The verdicts returned are in the order of the cases.
pub(super) fn verdicts(cases: &[Case], runner: Runner, mut tick: impl FnMut(&[Row])) -> Verdicts {
    let groups = groups(cases);
    let mut all: Vec<(usize, Verdicts)> = Vec::new();
    let mut take = |number: usize, verdicts: Verdicts| {
        tick(&verdicts.0);
        all.push((number, verdicts));
    };
    if runner.device.is_some() {
        let mut runner = runner;
        for (number, group) in groups.iter().enumerate() {
            take(number, verdicts_of(group, &mut runner));
        }
    } else {
        let setting = &runner.setting;
        let (send, receive) = mpsc::channel();
        let numbered: Vec<(usize, &[Case])> = groups.into_iter().enumerate().collect();
        thread::scope(|scope| {
            scope.spawn(move || {
                side_by_side(&numbered, |&(number, group)| {
                    let mut runner = Runner::new(setting.clone(), None);
                    let sent = send.send((number, verdicts_of(group, &mut runner)));
                    sent.expect("the receiver waits for all");
                });
            });
            for (number, verdicts) in receive {
                take(number, verdicts);
            }
        });
    }
    all.sort_unstable_by_key(|&(number, _)| number);
    let map = all.iter_mut().find_map(|(_, (_, map))| map.take());
    let rows = all.into_iter().flat_map(|(_, (rows, _))| rows);
    (rows.collect(), map)
}

/// Runs the cases of a group, which share their runs.
fn verdicts_of(group: &[Case], runner: &mut Runner) -> Verdicts {
    let mut rows = Vec::new();
    runner.measured = None;
    for case in group {
        let begin = Instant::now();
        let mut result = (case.run)(runner);
        let limits = result.as_mut().ok().and_then(|worst| worst.limits.take());
        rows.push(Row::new(case, result, begin.elapsed().as_secs_f64()));
        if let Some(limits) = limits {
            rows.push(Row::new(&energy::limits_of(case), Ok(*limits), 0.0));
        }
    }
    (rows, runner.map.take())
}
