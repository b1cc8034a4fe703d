// HostScene: a host with a picture of its own: a chequered floor and a red post before the water, a blue one behind it, ray-traced in one
// shader, in a framebuffer of any format and depth convention.
#pragma once

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <vector>

#include "engine/render/frame_view.h"
#include "fluid/render/host_target.h"
#include "tests/unit/host_picture.h"

namespace rivulet::testing {

class HostScene {
  public:
    struct Options {
        GLenum colour = GL_RGBA8, depth = GL_DEPTH24_STENCIL8;
        bool zeroToOne = false, reversed = false;
        int samples = 0, left = 0, bottom = 0;  // the viewport's place
        bool textures = true;                   // else renderbuffers
        bool upperLeft = false;
        std::function<void(FrameView&)> camera = {};  // changes the plain one into the host's
    };

    HostScene(int width, int height) : HostScene(width, height, Options{}) {}
    HostScene(int width, int height, const Options& options) : width_(width), height_(height), o_(options) {
        const int w = width + o_.left, h = height + o_.bottom;
        const bool both = o_.depth == GL_DEPTH24_STENCIL8 || o_.depth == GL_DEPTH32F_STENCIL8;
        glCreateFramebuffers(1, &framebuffer_);
        attach(GL_COLOR_ATTACHMENT0, o_.colour, w, h);
        attach(both ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, o_.depth, w, h);
        EXPECT_EQ(glCheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
        draw();
    }

    // Of the picture, without GL state left behind.
    void draw() {
        const GLuint program = hostPicture();
        GLuint array = 0;
        glCreateVertexArrays(1, &array);
        glm::dmat4 exact = worldToClip();
        if (o_.upperLeft)
            for (int column = 0; column < 4; ++column) exact[column].y *= -1;
        const mat4 clip(exact), back(glm::inverse(exact));
        const auto at = [&](const char* name) { return glGetUniformLocation(program, name); };
        glProgramUniformMatrix4fv(program, at("back"), 1, GL_FALSE, &back[0][0]);
        glProgramUniformMatrix4fv(program, at("clip"), 1, GL_FALSE, &clip[0][0]);
        glProgramUniform2f(program, at("ends"),
                           o_.reversed    ? 1.0F
                           : o_.zeroToOne ? 0.0F
                                          : -1.0F,
                           o_.reversed ? 0.1F : 0.5F);  // clip z of two points
        glProgramUniform4f(program, at("place"), static_cast<float>(o_.left), static_cast<float>(o_.bottom), static_cast<float>(width_),
                           static_cast<float>(height_));
        glProgramUniform1i(program, at("zeroToOne"), o_.zeroToOne ? 1 : 0);
        glProgramUniform1i(program, at("isLinear"), o_.colour == GL_RGBA16F ? 1 : 0);
        glClipControl(o_.upperLeft ? GL_UPPER_LEFT : GL_LOWER_LEFT, o_.zeroToOne ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glViewport(o_.left, o_.bottom, width_, height_);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_ALWAYS);
        glUseProgram(program);
        glBindVertexArray(array);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glBindVertexArray(0);
        glUseProgram(0);
        glDepthFunc(GL_LESS);
        glDisable(GL_DEPTH_TEST);
        glDeleteVertexArrays(1, &array);
        glDeleteProgram(program);
    }

    FrameView view() const {
        FrameView v;
        v.width = width_;
        v.height = height_;
        v.cameraPosWorld = vec3(0.5F, 0.75F, 2.1F);
        v.view = glm::lookAt(v.cameraPosWorld, vec3(0.5F, 0.25F, 0.4F), vec3(0, 1, 0));
        v.nearPlane = 0.1F;
        v.farPlane = 20.0F;
        v.lightColour = vec3(1.0F);
        v.projection = plain();
        if (o_.zeroToOne) v.projection = glm::perspectiveRH_ZO(0.9F, aspect(), o_.reversed ? 20.0F : 0.1F, o_.reversed ? 0.1F : 20.0F);
        if (o_.camera) o_.camera(v);
        return v;
    }
    // Of metres, in double precision.
    glm::dmat4 worldToClip() const {
        const FrameView v = view();
        glm::dmat4 world(double{v.unitsPerMetre});
        world[3][3] = 1;
        return glm::dmat4(v.projection) * glm::dmat4(v.view) * world;
    }
    HostTarget target() const { return {.framebuffer = framebuffer_, .x = o_.left, .y = o_.bottom, .width = width_, .height = height_}; }

    // rgb as a screen shows it, 0..1, and a as stored; the bottom row first.
    std::vector<vec4> pixels() const {
        const GLuint from = resolved();
        std::vector<vec4> all(static_cast<size_t>(width_) * static_cast<size_t>(height_));
        glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
        glReadPixels(o_.left, o_.bottom, width_, height_, GL_RGBA, GL_FLOAT, all.data());
        if (o_.colour == GL_RGBA16F)
            for (vec4& p : all)
                for (int k = 0; k < 3; ++k) {
                    const float c = std::clamp(p[k], 0.0F, 1.0F);
                    p[k] = c < 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F;
                }
        return all;
    }
    // m along the view axis; what is nothing far away. Of a plain camera.
    std::vector<float> depths() const {
        std::vector<float> all = windowDepths();
        const mat4 p = view().projection;
        for (float& z : all) z = p[3][2] / ((o_.zeroToOne ? z : 2 * z - 1) + p[2][2]);
        return all;
    }
    // m, world: what each pixel shows. Of any camera.
    std::vector<vec3> places() const {
        const std::vector<float> windows = windowDepths();
        const glm::dmat4 back = glm::inverse(worldToClip());
        std::vector<vec3> all;
        all.reserve(windows.size());
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const double z = windows[all.size()], up = o_.upperLeft ? -1 : 1;
                const glm::dvec4 at =
                    back * glm::dvec4((2 * x + 1.0) / width_ - 1, up * ((2 * y + 1.0) / height_ - 1), o_.zeroToOne ? z : 2 * z - 1, 1);
                all.emplace_back(glm::dvec3(at) / at.w);
            }
        return all;
    }

  private:
    std::vector<float> windowDepths() const {
        const GLuint from = resolved();
        std::vector<float> all(static_cast<size_t>(width_) * static_cast<size_t>(height_));
        glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
        glReadPixels(o_.left, o_.bottom, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, all.data());
        return all;
    }
    float aspect() const { return static_cast<float>(width_) / static_cast<float>(height_); }
    mat4 plain() const { return glm::perspective(0.9F, aspect(), 0.1F, 20.0F); }
    void attach(GLenum where, GLenum format, int w, int h) {
        GLuint name = 0;
        if (o_.textures) {
            glCreateTextures(o_.samples > 0 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D, 1, &name);
            if (o_.samples > 0)
                glTextureStorage2DMultisample(name, o_.samples, format, w, h, GL_TRUE);
            else
                glTextureStorage2D(name, 1, format, w, h);
            glNamedFramebufferTexture(framebuffer_, where, name, 0);
        } else {
            glCreateRenderbuffers(1, &name);
            glNamedRenderbufferStorageMultisample(name, o_.samples, format, w, h);
            glNamedFramebufferRenderbuffer(framebuffer_, where, GL_RENDERBUFFER, name);
        }
    }
    GLuint resolved() const {
        if (o_.samples == 0) return framebuffer_;
        Options single = o_;
        single.samples = 0;
        const HostScene other(width_, height_, single);
        const int w = width_ + o_.left, h = height_ + o_.bottom;
        glBlitNamedFramebuffer(framebuffer_, other.framebuffer_, 0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT,
                               GL_NEAREST);
        return other.framebuffer_;
    }

    int width_, height_;
    Options o_;
    GLuint framebuffer_ = 0;
};

}  // namespace rivulet::testing
