// The final step of the filter `none`, which changes no depth.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
void main() { end(begin()); }
