//! building_blocks_mesh: a dual method; negative is inside.

mod isograde;
mod league;
use building_blocks_core::prelude::*;
use building_blocks_mesh::{surface_nets, SurfaceNetsBuffer};
use building_blocks_storage::prelude::*;
use isograde::{Extract, Mesh, Sample};

struct Nets;

impl Extract for Nets {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, _spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let [nx, ny, nz] = shape.map(|n| n as i32);
        let extent = Extent3i::from_min_and_shape(Point3i::ZERO, PointN([nx, ny, nz]));
        let samples = Array3x1::fill_with(extent, |p: Point3i| {
            let at = (p.x() * ny + p.y()) * nz + p.z();
            (isovalue - values[at as usize].number()) as f32
        });
        let mut buffer = SurfaceNetsBuffer::default();
        surface_nets(&samples, &extent, 1.0, &mut buffer);
        // It counts from the corner of the first voxel.
        let place = |at: &[f32; 3]| at.map(|a| f64::from(a) - 0.5);
        Ok(Mesh {
            vertices: buffer.mesh.positions.iter().map(place).collect(),
            triangles: league::threes(&buffer.mesh.indices),
        })
    }
}

fn main() -> std::io::Result<()> {
    league::serve(Nets)
}
