// The picture of HostScene (host_fixture.h): a shader that traces rays to a floor and two posts, and writes their colour and depth.
#pragma once

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <array>
#include <string>
#include <utility>

namespace rivulet::testing {

// A program for one triangle over the viewport; the caller deletes it.
inline GLuint hostPicture() {
    GLuint program = glCreateProgram();
    const std::string vertex =
        "#version 450\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.5, 1.0); }";
    const std::string fragment = R"(#version 450
uniform mat4 back, clip; uniform vec4 place; uniform vec2 ends; uniform bool zeroToOne, isLinear; vec3 eye;
layout(location = 0) out vec4 colour;
float post(vec3 d, vec2 at, float r) {
    vec2 o = eye.xz - at; float a = dot(d.xz, d.xz), b = dot(o, d.xz), c = dot(o, o) - r * r, q = b * b - a * c;
    float t = q < 0.0 ? -1.0 : (-b - sqrt(q)) / a; float y = eye.y + t * d.y;
    return t > 0.0 && y > 0.0 && y < 0.9 ? t : 1e9;
}
void main() {
    vec2 uv = (gl_FragCoord.xy - place.xy) / place.zw * 2.0 - 1.0;
    vec4 a = back * vec4(uv, ends.x, 1.0), b_ = back * vec4(uv, ends.y, 1.0); eye = a.xyz / a.w;
    vec3 d = normalize(b_.xyz * a.w - a.xyz * b_.w) * sign(a.w);  // b may be beyond infinity
    float t = d.y < 0.0 ? -eye.y / d.y : 1e9; vec3 c = vec3(0.3, 0.45, 0.6);
    vec3 p = eye + t * d;
    if (t < 1e8) c = mod(floor(8.0 * p.x) + floor(8.0 * p.z), 2.0) < 1.0 ? vec3(0.5, 0.48, 0.45) : vec3(0.2, 0.2, 0.22);
    float r = post(d, vec2(0.32, 1.1), 0.05), b = post(d, vec2(0.5, -0.2), 0.06);
    if (r < t) { t = r; c = vec3(0.7, 0.1, 0.08); }
    if (b < t) { t = b; c = vec3(0.1, 0.15, 0.7); }
    colour = vec4(isLinear ? c : mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)), 0.25);
    vec4 at = clip * vec4(eye + t * d, 1.0); float z = at.z / at.w;
    gl_FragDepth = t > 1e8 ? (ends.x > ends.y ? 0.0 : 1.0) : zeroToOne ? z : 0.5 * z + 0.5;
})";
    for (const auto& [kind, text] : {std::pair(GL_VERTEX_SHADER, &vertex), std::pair(GL_FRAGMENT_SHADER, &fragment)}) {
        const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
        const char* lines = text->c_str();
        glShaderSource(shader, 1, &lines, nullptr);
        glCompileShader(shader);
        GLint fine = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
        std::array<char, 2000> log{};
        glGetShaderInfoLog(shader, 2000, nullptr, log.data());
        EXPECT_EQ(fine, GL_TRUE) << log.data();
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    return program;
}

}  // namespace rivulet::testing
