use incise_mesh::*;
use incise_pbd_gpu::*;
use incise_scene::*;
fn box_of(sides: [f64; 3], cells: [u32; 3]) -> Surface {
    let mut corners = vec![];
    let mut faces = vec![];
    let mut numbers = std::collections::BTreeMap::new();
    let mut vertex = |at: [u32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            let place = |k: usize| (sides[k] * (at[k] as f64 / cells[k] as f64 - 0.5)) as f32;
            corners.push([place(0), place(1) + (sides[1] / 2.0) as f32, place(2)]);
            corners.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
        for (level, top) in [(0, false), (cells[axis], true)] {
            for i in 0..cells[one] {
                for j in 0..cells[other] {
                    let mut at = |di: u32, dj: u32| {
                        let mut p = [level; 3];
                        p[one] = i + di;
                        p[other] = j + dj;
                        vertex(p)
                    };
                    let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                    let both = if (i + j) % 2 == 0 {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    };
                    faces.extend(both.map(|[a, b, c]| if top { [a, b, c] } else { [a, c, b] }));
                }
            }
        }
    }
    Surface::from_triangles(&corners, &faces).unwrap()
}
fn main() {
    let a: Vec<f64> = std::env::args()
        .skip(1)
        .map(|x| x.parse().unwrap())
        .collect();
    let (cells, thick, h, cut) = (a[0] as u32, a[1] as f32, a[2], a[3]);
    let s = box_of([1.0, h, 1.0], [cells, 1, cells]);
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams {
            ground: Some(0.0),
            ..SolverParams::default()
        },
        contacts: Some(ContactParams {
            thickness: thick,
            ..Default::default()
        }),
        sleep: None,
        ..Default::default()
    });
    let m = Material::soft_body();
    let b = scene.add_body(s, &m).unwrap();
    if cut > 0.0 {
        let y = (0.52 * h) as f32;
        let k = scene.add_blade([[-2.0, y, -2.0], [-2.0, y, 2.0]]);
        scene
            .move_blade(k, [[2.0, y, -2.0], [2.0, y, 2.0]])
            .unwrap();
    }
    for f in 0..180 {
        scene.step().unwrap();
        let body = scene.body(b).unwrap();
        if f < 12 || f % 30 == 29 {
            let vs = body.surface().piece_volumes();
            let v: Vec<String> = body
                .solver()
                .volumes()
                .pieces()
                .iter()
                .map(|p| format!("{:.4}", vs[p.piece() as usize] / p.rest() as f64))
                .collect();
            let sp = body
                .solver()
                .velocities()
                .iter()
                .map(|v| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt())
                .fold(0f32, f32::max);
            println!(
                "{f} contacts {} springs {} V {} speed {sp:.4} edge {:.3}",
                scene.stats().contacts,
                body.solver().interior_springs().map_or(0, |s| s.len()),
                v.join(" "),
                body.solver().mean_rest_length()
            );
        }
    }
}
