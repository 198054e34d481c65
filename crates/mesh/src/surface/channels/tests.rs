//! Rules by which channels blend, and sizes that are refused.

use super::*;
use proptest::prelude::*;

fn row(values: &[f32]) -> Row {
    let mut out = Row::default();
    out[..values.len()].copy_from_slice(values);
    out
}

#[test]
fn joints_of_three_parents_are_merged_to_the_largest_four() {
    let a = row(&[1.0, 2.0, 3.0, 4.0, 0.4, 0.3, 0.2, 0.1]);
    let b = row(&[2.0, 5.0, 6.0, 7.0, 0.7, 0.1, 0.1, 0.1]);
    let got = Blend::Skin.rows(8, [(a, 0.5), (b, 0.5)]);
    // Joint 2 has 0.5, joint 1 has 0.2, joint 3 has 0.1; 4 to 7 have 0.05 each.
    assert_eq!(got[..4], [2.0, 1.0, 3.0, 4.0]);
    for (weight, expected) in got[4..8].iter().zip([0.5, 0.2, 0.1, 0.05]) {
        assert!((weight - expected / 0.85).abs() < 1e-6, "{got:?}");
    }
    assert_eq!(Blend::Skin.rows(8, [(a, 1.0), (b, 0.0)]), a);
}

#[test]
fn channels_of_another_size_are_refused() {
    let mut surface = crate::icosphere(0, 1.0);
    let before = surface.clone();
    let channel =
        |blend, width, values| Channel::new("c", Domain::Vertex, blend, width, vec![0.0; values]);
    for (blend, width) in [(Blend::Linear, 0), (Blend::Linear, 17), (Blend::Skin, 3)] {
        assert!(channel(blend, width, 0).is_err());
    }
    let error = surface.set_channel(channel(Blend::Linear, 2, 23).unwrap());
    assert_eq!(
        error.unwrap_err().to_string(),
        "channel c: 23 values; the surface needs 24, one row per slot"
    );
    assert_eq!(surface, before, "nothing changes");
    surface
        .set_channel(channel(Blend::Linear, 2, 24).unwrap())
        .unwrap();
    surface
        .set_channel(channel(Blend::Skin, 2, 24).unwrap())
        .unwrap();
    assert_eq!(surface.channels().len(), 1, "the name is the same");
    assert_eq!(surface.remove_channel("c").unwrap().blend(), Blend::Skin);
    assert_eq!(surface, before);
}

proptest! {
    #[test]
    fn means_lie_between_the_parents(
        values in prop::array::uniform3(prop::array::uniform4(-1e3_f32..1e3)),
        weights in prop::array::uniform3(0.0_f64..1.0),
    ) {
        let sum: f64 = weights.iter().sum();
        prop_assume!(sum > 0.0);
        let rows = [0, 1, 2].map(|i| (row(&values[i]), weights[i] / sum));
        let mean = Blend::Linear.rows(4, rows);
        for k in 0..4 {
            let own = [0, 1, 2].map(|i| values[i][k]);
            prop_assert!(own.iter().any(|&x| x <= mean[k]), "{mean:?}");
            prop_assert!(own.iter().any(|&x| x >= mean[k]), "{mean:?}");
        }
    }

    #[test]
    fn skin_weights_sum_to_one(
        joints in prop::array::uniform3(prop::array::uniform4(0_u8..9)),
        values in prop::array::uniform3(prop::array::uniform4(0.01_f32..1.0)),
        weights in prop::array::uniform3(0.01_f64..1.0),
    ) {
        let sum: f64 = weights.iter().sum();
        let rows = [0, 1, 2].map(|i| {
            let total: f32 = values[i].iter().sum();
            let shares = values[i].map(|x| x / total);
            let all = [joints[i].map(f32::from), shares].concat();
            (row(&all), weights[i] / sum)
        });
        let got = Blend::Skin.rows(8, rows);
        let total: f64 = got[4..8].iter().map(|&x| f64::from(x)).sum();
        prop_assert!((total - 1.0).abs() < 1e-6, "{got:?}");
        prop_assert!(got[4..8].is_sorted_by(|a, b| a >= b), "{got:?}");
        let known = joints.concat();
        let is_known = |&joint: &f32| known.iter().any(|&k| f32::from(k) == joint);
        prop_assert!(got[..4].iter().all(|joint| *joint == 0.0 || is_known(joint)));
    }
}
