//! mcubes: marching cubes; the first axis is fastest.

mod isograde;
mod league;
use isograde::{Extract, Mesh, Sample};
use lin_alg::f32::Vec3;
use mcubes::{MarchingCubes, MeshSide};

struct Cubes;

impl Extract for Cubes {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        // It multiplies indices by the size over the interval.
        let [x, y, z] = spacing.map(|step| step as f32);
        let cubes = MarchingCubes::new(
            shape.into(),
            (x, y, z),
            (1.0, 1.0, 1.0),
            Vec3::new(0.0, 0.0, 0.0),
            league::x_fastest(values, shape, |value| value as f32),
            isovalue as f32,
        )
        .map_err(|error| error.to_string())?;
        let mesh = cubes.generate(MeshSide::OutsideOnly);
        let place = |at: Vec3| [at.x, at.y, at.z].map(f64::from);
        Ok(Mesh {
            vertices: mesh.vertices.iter().map(|v| place(v.posit)).collect(),
            triangles: league::threes(&mesh.indices),
        })
    }
}

fn main() -> std::io::Result<()> {
    league::serve(Cubes)
}
