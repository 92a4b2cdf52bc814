// The square that the raster ways draw into: a pixel is a column along a triangle's dominant axis. As wide as the largest grid
// (kRasterSide in triangle_pass.cpp), a power of two, so that columns come to clip space without rounding.
vec4 columnToClip(vec2 column) { return vec4(column * (2.0 / 1024.0) - 1.0, 0.5, 1.0); }
