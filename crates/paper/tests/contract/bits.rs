//! Seeded cuts of a model: the same input gives the same bits.

use incise_cut::{Cutter, Sweep};
use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_paper::{PaperParams, cut};
use incise_test_support::bits::hash;

/// Planes through the Bunny, with the number of pieces and their hash.
const CUTS: [([f64; 3], f64, usize, u32); 10] = [
    (
        [
            0.989_354_049_318_785_3,
            -0.260_839_500_758_061_06,
            -0.778_258_510_813_642_8,
        ],
        0.026_779_375_592_428_1,
        2,
        0x2507_2f14,
    ),
    (
        [
            -0.523_709_786_479_293_8,
            0.754_028_701_166_163_3,
            -0.566_576_730_359_014_3,
        ],
        -0.044_209_101_166_159_17,
        2,
        0x05fe_9620,
    ),
    (
        [
            0.268_237_228_334_936_6,
            -0.791_852_316_305_007,
            0.756_265_436_242_396_4,
        ],
        -0.059_549_915_792_781_37,
        4,
        0x4b95_962a,
    ),
    (
        [
            -0.120_239_871_814_902_81,
            -0.682_801_775_094_774,
            -0.193_204_948_025_104_8,
        ],
        0.033_657_244_100_155_59,
        2,
        0x5ef0_74a1,
    ),
    (
        [
            -0.117_575_301_583_291_77,
            0.747_765_370_120_239_8,
            -0.952_530_674_159_650_4,
        ],
        -0.087_256_724_698_761_65,
        2,
        0x11d8_1691,
    ),
    (
        [
            -0.820_774_343_754_345_1,
            0.337_389_717_655_58,
            0.386_129_876_455_788_1,
        ],
        0.060_735_323_305_878_636,
        3,
        0xe7ef_7e73,
    ),
    (
        [
            -0.878_595_991_031_871_1,
            -0.135_778_251_834_162_14,
            0.459_300_635_256_641_8,
        ],
        0.102_500_427_712_802_88,
        3,
        0x15c4_bb52,
    ),
    (
        [
            0.771_372_380_613_203_3,
            0.033_777_142_649_930_26,
            0.899_474_702_752_073_1,
        ],
        -0.071_168_012_200_195_35,
        2,
        0xb959_6dc2,
    ),
    (
        [
            0.092_481_138_904_691_12,
            -0.136_247_388_351_766_2,
            0.404_093_024_647_816_27,
        ],
        -0.011_623_774_064_151_516,
        4,
        0xf742_abc4,
    ),
    (
        [
            0.791_130_240_026_658_9,
            0.725_233_226_950_567_5,
            0.028_245_507_513_230_184,
        ],
        0.125_071_921_426_586_77,
        3,
        0x1c27_86c8,
    ),
];

#[test]
fn seeded_cuts_have_the_listed_bits() {
    for (normal, d, count, expected) in CUTS {
        let mut surface = build_model(Model::Bunny);
        let plane = Sweep::from_plane(normal, d, &surface.bounds()).unwrap();
        let mut cutter = Cutter::new(&surface);
        let _ = cut(&mut cutter, &mut surface, &plane, &PaperParams::default()).unwrap();
        let pieces: Vec<Surface> = surface.extract_pieces().map(|(_, piece)| piece).collect();
        assert_eq!(
            (pieces.len(), hash(&pieces)),
            (count, expected),
            "{normal:?}"
        );
    }
}
