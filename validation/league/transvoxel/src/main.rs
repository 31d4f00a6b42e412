//! transvoxel: marching cubes of a block, here without sides of another resolution.

mod isograde;
mod league;
use isograde::{Extract, Mesh, Sample};
use transvoxel::prelude::*;

struct Cubes;

impl Extract for Cubes {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, _spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let n = shape[0];
        let sample = |x: f32, y: f32, z: f32| {
            // It asks beyond the block for its gradients.
            let [i, j, k] = [x, y, z].map(|a| (a.round().max(0.0) as usize).min(n - 1));
            values[(i * n + j) * n + k].number() as f32
        };
        let mesh = extract_from_field(
            &sample,
            FieldCaching::CacheNothing,
            Block::new([0.0; 3], (n - 1) as f32, n - 1),
            TransitionSide::none(),
            isovalue as f32,
            GenericMeshBuilder::new(),
        )
        .build();
        Ok(Mesh {
            vertices: league::places(&mesh.positions),
            triangles: league::threes(&mesh.triangle_indices),
        })
    }
}

fn main() -> std::io::Result<()> {
    league::serve(Cubes)
}
