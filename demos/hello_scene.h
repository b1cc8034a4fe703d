// The host's own scene: a pool of 1.2 m in a terrace, its front of glass, a mosaic and a pole in it, and a post before it.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <glm/glm.hpp>
#include <utility>

// What the host draws: n.x by n.y tiles over u and v, or (n = 0) a post of radius u.x and height v.y, its side and its top.
inline const char* const kVertex = R"(#version 450
uniform mat4 clip; uniform vec3 at, u, v; uniform vec2 n; out vec3 normal; out vec2 tile;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    float turn = 0.1308997 * (gl_VertexID >> 1);
    vec3 round = vec3(cos(turn), 0.0, sin(turn)), p = at + corner.x * u + corner.y * v;
    normal = normalize(cross(u, v)); tile = corner * n;
    if (n.x == 0.0 && gl_VertexID < 98) { p = at + u.x * round + v * (gl_VertexID & 1); normal = round; }
    if (n.x == 0.0 && gl_VertexID >= 98) { p = at + v + u.x * round * (gl_VertexID & 1); normal = vec3(0.0, 1.0, 0.0); }
    gl_Position = clip * vec4(p, 1.0);
})";
inline const char* const kFragment = R"(#version 450
uniform vec3 one, other; in vec3 normal; in vec2 tile; out vec4 colour;
void main() {
    vec2 soft = max(fwidth(tile), 1e-6), wave = clamp((abs(fract(0.5 * tile) - 0.5) - 0.25) * 2.0 / soft, -0.5, 0.5) * clamp(0.7 / soft, 0.0, 1.0);
    vec3 c = mix(one, other, 0.5 + 2.0 * wave.x * wave.y) * (vec3(0.34, 0.36, 0.40) + vec3(0.72, 0.70, 0.65) *
             max(dot(normalize(normal), normalize(vec3(0.4, 0.8, 0.45))), 0.0));
    colour = vec4(c, 1.0);
})";
struct Part {
    glm::vec3 at, u, v;
    glm::vec2 n;
    glm::vec3 one, other;
};
inline constexpr glm::vec3 kPale(0.72F, 0.86F, 0.86F), kWhite(0.84F, 0.93F, 0.92F), kStone(0.86F, 0.80F, 0.71F), kDark(0.80F, 0.74F, 0.65F);
inline constexpr glm::vec3 kBlue(0.16F, 0.33F, 0.62F), kRed(0.78F, 0.24F, 0.16F), kGold(0.93F, 0.70F, 0.22F);
inline const Part kParts[] = {{{0, 0, 1.2F}, {1.2F, 0, 0}, {0, 0, -1.2F}, {16, 16}, kPale, kWhite},
                              {{0.3F, 0.002F, 0.9F}, {0.6F, 0, 0}, {0, 0, -0.6F}, {8, 8}, kBlue, kWhite},
                              {{0, 0, 0}, {1.2F, 0, 0}, {0, 0.42F, 0}, {16, 6}, kPale, kWhite},
                              {{0, 0, 1.2F}, {0, 0, -1.2F}, {0, 0.42F, 0}, {16, 6}, kPale, kWhite},
                              {{1.2F, 0, 0}, {0, 0, 1.2F}, {0, 0.42F, 0}, {16, 6}, kPale, kWhite},
                              {{-9, 0.42F, 0}, {19.2F, 0, 0}, {0, 0, -9}, {96, 45}, kStone, kDark},
                              {{-9, 0.42F, 1.2F}, {9, 0, 0}, {0, 0, -1.2F}, {45, 6}, kStone, kDark},
                              {{1.2F, 0.42F, 1.2F}, {9, 0, 0}, {0, 0, -1.2F}, {45, 6}, kStone, kDark},
                              {{-9, 0, 3}, {19.2F, 0, 0}, {0, 0, -1.8F}, {96, 9}, kStone, kDark},
                              {{-2.4F, 0, 1.2F}, {2.4F, 0, 0}, {0, 0.42F, 0}, {12, 2}, kStone, kDark},
                              {{1.2F, 0, 1.2F}, {2.4F, 0, 0}, {0, 0.42F, 0}, {12, 2}, kStone, kDark},
                              {{0.14F, 0, 1.42F}, {0.05F, 0, 0}, {0, 0.27F, 0}, {0, 0}, kRed, kRed},
                              {{0.72F, 0, 0.40F}, {0.016F, 0, 0}, {0, 0.80F, 0}, {0, 0}, kGold, kGold}};

// The program that draws them, or 0.
inline GLuint sceneProgram() {
    const GLuint program = glCreateProgram();
    for (const auto& [kind, text] : {std::pair(GL_VERTEX_SHADER, kVertex), std::pair(GL_FRAGMENT_SHADER, kFragment)}) {
        const GLuint shader = glCreateShader(kind);
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        glAttachShader(program, shader);
    }
    glLinkProgram(program);
    return program;
}

// With that program in use, and a vertex array bound.
inline void drawScene(GLuint program, const glm::mat4& clip) {
    const auto place = [&](const char* name) { return glGetUniformLocation(program, name); };
    glUniformMatrix4fv(place("clip"), 1, GL_FALSE, &clip[0][0]);
    for (const Part& p : kParts) {
        for (const auto& [name, v] : {std::pair("at", p.at), {"u", p.u}, {"v", p.v}, {"one", p.one}, {"other", p.other}})
            glUniform3fv(place(name), 1, &v[0]);
        glUniform2fv(place("n"), 1, &p.n[0]);
        glDrawArrays(GL_TRIANGLE_STRIP, 0, p.n.x > 0 ? 4 : 196);
    }
}
