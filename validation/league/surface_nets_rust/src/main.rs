//! surface-nets: a dual method of cubes of samples; negative is inside.

mod isograde;
mod league;
use isograde::{Extract, Mesh, Sample};
use surface_nets::surface_net;

struct Nets;

impl Extract for Nets {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, _spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let n = shape[0];
        let samples: Vec<f32> = values.iter().map(|v| (isovalue - v.number()) as f32).collect();
        let sample = move |x: usize, y: usize, z: usize| samples[(x * n + y) * n + z];
        // The resolution is the number of cells.
        let (vertices, _, indices) = surface_net(n - 1, &sample, false);
        Ok(Mesh {
            vertices: vertices.iter().map(|p| p.map(f64::from)).collect(),
            triangles: league::threes(&indices),
        })
    }
}

fn main() -> std::io::Result<()> {
    league::serve(Nets)
}
