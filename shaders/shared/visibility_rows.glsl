// Reading visibility rows: chunks of entries by device address (layout: shaders/shared/voxel.h).
#ifndef RADIVOX_SHADERS_SHARED_VISIBILITY_ROWS_GLSL
#define RADIVOX_SHADERS_SHARED_VISIBILITY_ROWS_GLSL
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/voxel.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Entries { uint words[]; };

// Where rowStart holds the first entry of face s; the next word holds the end.
uint rowSlot(uint s) { return s + s / kRowsPerChunk; }
Entries chunkEntries(uvec2 address) { return Entries(address); }

#endif
