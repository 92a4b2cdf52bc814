#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "clustered_voxel/voxelize/triangles_visit.glsl"
#include "clustered_voxel/voxelize/columns_raster.glsl"
