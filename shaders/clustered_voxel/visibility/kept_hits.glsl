// The words of shared KeptHits. Before including: the extensions GL_EXT_buffer_reference and GL_EXT_buffer_reference_uvec2.
#ifndef RADIVOX_CLUSTERED_VOXEL_KEPT_HITS_GLSL
#define RADIVOX_CLUSTERED_VOXEL_KEPT_HITS_GLSL
#include "clustered_voxel/visibility/kept_hits.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer KeptWords { uint words[]; };
uint keptWord(KeptHits kept, uint at) { return KeptWords(kept.address).words[at]; }
#endif
