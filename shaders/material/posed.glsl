// POSED: the pose of a mesh that moves with a body on the device. It is read where a kernel has written it: no host has to know it.
uniform samplerBuffer poseRows;  // of each body a row: its place (m), then its rotation (a unit quaternion, w last), then others
uniform int poseTexel;           // the first of the row

// The body's frame -> the world; as the host makes it of a pose, to the last bit.
mat4 poseMatrix() {
    vec4 place = texelFetch(poseRows, poseTexel), q = texelFetch(poseRows, poseTexel + 1);
    vec3 squares = q.xyz * q.xyz, mixed = q.xxy * q.yzz, turned = q.w * q.xyz;  // mixed: xy, xz, yz
    return mat4(vec4(1.0 - 2.0 * (squares.y + squares.z), 2.0 * (mixed.x + turned.z), 2.0 * (mixed.y - turned.y), 0.0),
                vec4(2.0 * (mixed.x - turned.z), 1.0 - 2.0 * (squares.x + squares.z), 2.0 * (mixed.z + turned.x), 0.0),
                vec4(2.0 * (mixed.y + turned.y), 2.0 * (mixed.z - turned.x), 1.0 - 2.0 * (squares.x + squares.y), 0.0),
                vec4(place.xyz, 1.0));
}
