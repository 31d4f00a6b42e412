//! Marching cubes in Rust, the example of the kit: put your own extractor in its place.
//!
//! A sample is inside where it is at least the isovalue. Each pattern of inside corners has its
//! triangles in `TRIANGLES` (table.rs), which cuts the inside corners of an ambiguous face apart,
//! on every face alike: so the surface is closed. A vertex belongs to a lattice edge, named by the
//! sample at its lower end and its axis, and is made by the first cell that asks for it.

mod isograde;
#[rustfmt::skip]
mod table;

use isograde::{Extract, Mesh, Sample};
use table::{LOWER, TRIANGLES};

/// Where between two samples, one inside, the line through both takes the isovalue: 0 to 1. Low and
/// high are the samples minus the isovalue.
fn crossing(low: f64, high: f64) -> f64 {
    if low == 0.0 {
        0.0
    } else {
        1.0 / (1.0 - high / low)
    }
}

struct MarchingCubes;

impl Extract for MarchingCubes {
    fn extract<T: Sample>(
        &self,
        values: &[T],
        shape: [usize; 3],
        isovalue: f64,
        spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        if values.is_empty() {
            return Err("there are no samples".into());
        }
        if values.iter().any(|value| !(value.number() - isovalue).is_finite()) {
            return Err("a sample minus the isovalue is no finite number".into());
        }

        let mut mesh = Mesh::default();
        let stride = [shape[1] * shape[2], shape[2], 1];
        // The vertex on each lattice edge, counted from 1; 0 where there is none.
        let mut vertex = vec![0; 3 * values.len()];
        for x in 0..shape[0] - 1 {
            for y in 0..shape[1] - 1 {
                for z in 0..shape[2] - 1 {
                    // Read the samples at the corners; bit a of c is a step along axis a.
                    let place = |c: usize| [x + (c & 1), y + (c >> 1 & 1), z + (c >> 2 & 1)];
                    let corner = |c| (0..3).map(|a| place(c)[a] * stride[a]).sum::<usize>();
                    let level = |c: usize| values[corner(c)].number() - isovalue;
                    let signs = (0..8).filter(|&c| level(c) >= 0.0).map(|c| 1 << c).sum::<usize>();

                    // Copy the triangles of these signs; make the vertices that are not there yet.
                    for letters in TRIANGLES[signs].as_bytes().chunks(3) {
                        let mut triangle = [0; 3];
                        for (k, letter) in letters.iter().enumerate() {
                            let edge = usize::from(letter - b'a');
                            let (low, axis) = (LOWER[edge], edge / 4);
                            let name = &mut vertex[3 * corner(low) + axis];
                            if *name == 0 {
                                let mut at = place(low).map(|i| i as f64);
                                at[axis] += crossing(level(low), level(low | 1 << axis));
                                mesh.vertices.push([0, 1, 2].map(|a| at[a] * spacing[a]));
                                *name = mesh.vertices.len();
                            }
                            triangle[k] = *name - 1;
                        }
                        mesh.triangles.push(triangle);
                    }
                }
            }
        }
        Ok(mesh)
    }
}

fn main() -> std::io::Result<()> {
    let declaration = r#"{"name": "marching cubes in Rust", "version": "1"}"#;
    isograde::serve(declaration, &MarchingCubes)
}
