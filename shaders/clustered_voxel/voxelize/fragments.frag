#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "clustered_voxel/voxelize/fragments_visit.glsl"
#include "clustered_voxel/voxelize/columns_raster.glsl"
