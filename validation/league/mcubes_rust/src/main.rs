//! mcubes: marching cubes; the first axis is fastest.

mod isograde;
use isograde::{Extract, Mesh, Sample};
use lin_alg::f32::Vec3;
use mcubes::{MarchingCubes, MeshSide};

struct Cubes;

impl Extract for Cubes {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let [nx, ny, nz] = shape;
        let mut samples = vec![0.0f32; values.len()];
        for x in 0..nx {
            for y in 0..ny {
                for z in 0..nz {
                    samples[x + nx * (y + ny * z)] = values[(x * ny + y) * nz + z].number() as f32;
                }
            }
        }
        // It multiplies indices by the size over the interval.
        let size = |a: usize| spacing[a] as f32;
        let cubes = MarchingCubes::new(
            (nx, ny, nz),
            (size(0), size(1), size(2)),
            (1.0, 1.0, 1.0),
            Vec3::new(0.0, 0.0, 0.0),
            samples,
            isovalue as f32,
        )
        .map_err(|error| error.to_string())?;
        let mesh = cubes.generate(MeshSide::OutsideOnly);
        Ok(Mesh {
            vertices: mesh
                .vertices
                .iter()
                .map(|v| [v.posit.x, v.posit.y, v.posit.z].map(f64::from))
                .collect(),
            triangles: mesh.indices.chunks(3).map(|t| [t[0], t[1], t[2]]).collect(),
        })
    }
}

fn main() -> std::io::Result<()> {
    isograde::serve(&std::fs::read_to_string(std::env::args().nth(1).unwrap())?, &Cubes)
}
