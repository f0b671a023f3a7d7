#pragma once

namespace csrbf::app {

// Extensions of the files that the commands read and write, as help and messages list them.
inline constexpr const char* point_formats = ".ply .xyz .pts .txt .csv .obj .off .npy .vtp";
inline constexpr const char* read_point_formats =
    ".ply .xyz .pts .txt .csv .obj .off .npy .vtp .stl .las .laz .e57 .pcd .ptx";
inline constexpr const char* written_mesh_formats = ".ply .obj .off .stl .vtp .glb .3mf";
inline constexpr const char* mesh_formats = ".ply .obj .off .stl .vtp";
inline constexpr const char* image_formats =
    ".png .pgm .ppm .jpg .bmp .tif .nii .nii.gz .nrrd .mha .mhd .npy .vti .asc .nc";
inline constexpr const char* label_formats = ".png .pgm .bmp .tif .nii .nii.gz .nrrd .mha .mhd .npy .vti .asc .nc";
inline constexpr const char* plane_contour_formats = ".svg .csv .ply .vtp";
inline constexpr const char* sample_formats =
    ".csv .txt .tsv .dat .xyz .npy, or - for text on standard input; points of a scanner (.las .ply .pcd and the "
    "like): z "
    "over x and y; maps (.gpkg .shp .geojson .tif .asc .nc)";

}  // namespace csrbf::app
