// Quads, one per row of buffers, drawn by FluidPrograms::drawQuads: four vertices per row, and kRows rows per instance.
// One instance per quad was three times slower on llvmpipe, and leaves most of a wave idle on a GPU.
// Or squares, by FluidPrograms::drawSplats: one vertex per row.
uniform uint firstRow, rows;  // the first that is drawn, and the end
uniform vec2 pointTarget;     // pixels of the target; x 0: quads are drawn, not points
const uint kRows = 4096u;
bool asPoint() { return pointTarget.x > 0.0; }
uint wanted() { return asPoint() ? uint(gl_VertexID) : firstRow + uint(gl_InstanceID) * kRows + uint(gl_VertexID >> 2); }
int row() { return int(min(wanted(), rows - 1u)); }
bool beyond() { return wanted() >= rows; }  // no such row: nothing is drawn
vec2 corner() { return vec2(float(gl_VertexID & 1), float((gl_VertexID >> 1) & 1)); }
const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);
// Row by texelFetch(n, row()): on llvmpipe half the cost of a storage buffer. `b` from 0, FluidPrograms::drawQuads's order.
#define ROWS(b, n) layout(binding = 24 + b) uniform samplerBuffer n;
