// The end of a filter that does nothing.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
void main() { end(begin()); }
