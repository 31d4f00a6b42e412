//! fast-surface-nets: a dual method; negative is inside, the first axis is fastest.

mod isograde;
use isograde::{Extract, Mesh, Sample};
use fast_surface_nets::{ndshape::RuntimeShape, surface_nets, SurfaceNetsBuffer};

struct Nets;

impl Extract for Nets {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, _spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let [nx, ny, nz] = shape;
        let mut samples = vec![0.0f32; values.len()];
        for x in 0..nx {
            for y in 0..ny {
                for z in 0..nz {
                    let value = values[(x * ny + y) * nz + z].number();
                    samples[x + nx * (y + ny * z)] = (isovalue - value) as f32;
                }
            }
        }
        let sizes = shape.map(|n| n as u32);
        let mut buffer = SurfaceNetsBuffer::default();
        let shape = RuntimeShape::<u32, 3>::new(sizes);
        surface_nets(&samples, &shape, [0; 3], sizes.map(|n| n - 1), &mut buffer);
        Ok(Mesh {
            vertices: buffer.positions.iter().map(|p| p.map(f64::from)).collect(),
            triangles: buffer
                .indices
                .chunks(3)
                .map(|t| [t[0] as usize, t[1] as usize, t[2] as usize])
                .collect(),
        })
    }
}

fn main() -> std::io::Result<()> {
    isograde::serve(&std::fs::read_to_string(std::env::args().nth(1).unwrap())?, &Nets)
}
