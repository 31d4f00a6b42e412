"""Files of volumes and of meshes: `reading` and `writing`, by the libraries that know the formats.

Which library reads what, and why that one:

| format | library | why |
| --- | --- | --- |
| NIfTI, MGH | nibabel | gives the affine as it stands; ITK refuses or straightens a sheared one |
| NRRD | pynrrd | gives a direction for each axis, and the name of the space |
| MetaImage, GIPL, DICOM | SimpleITK | what 3-D Slicer reads with; finds and sorts a DICOM series |
| VTK images | pyvista | VTK's own readers, with errors that can be caught |
| TIFF stacks | tifffile | knows ImageJ's and OME's sizes of a voxel |
| HDF5 | h5py | the library of the format |
| Zarr, OME-Zarr | zarr | the library of the format; OME's metadata are a few lines of JSON |
| npy, npz, raw | NumPy | nothing else is needed |

Meshes are written by trimesh, by meshio, and by pyvista (VTK's own PolyData); npz by NumPy.
"""
