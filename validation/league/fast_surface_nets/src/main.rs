//! fast-surface-nets: a dual method; negative is inside, the first axis is fastest.

mod isograde;
mod league;
use fast_surface_nets::{ndshape::RuntimeShape, surface_nets, SurfaceNetsBuffer};
use isograde::{Extract, Mesh, Sample};

struct Nets;

impl Extract for Nets {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, _spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let samples = league::x_fastest(values, shape, |value| (isovalue - value) as f32);
        let sizes = shape.map(|n| n as u32);
        let mut buffer = SurfaceNetsBuffer::default();
        let shape = RuntimeShape::<u32, 3>::new(sizes);
        surface_nets(&samples, &shape, [0; 3], sizes.map(|n| n - 1), &mut buffer);
        Ok(Mesh {
            vertices: buffer.positions.iter().map(|p| p.map(f64::from)).collect(),
            triangles: league::threes(&buffer.indices),
        })
    }
}

fn main() -> std::io::Result<()> {
    league::serve(Nets)
}
