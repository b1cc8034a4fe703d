#include "fluid/viewer/panel_layer.h"

#include <rivulet_glad/gl.h>

#include <algorithm>

#include "engine/core/thread_clock.h"

namespace rivulet {

void PanelLayer::begin(InputEvents input, double seconds) {
    began_ = threadSeconds();
    input.scale *= zoom_;
    ui_.begin(input, seconds);
}

void PanelLayer::made() { cost_.made = 1000 * (threadSeconds() - began_); }

void PanelLayer::drawTimed() {
    const double began = threadSeconds();
    ui_.draw();
    cost_.drawn = 1000 * (threadSeconds() - began);
}

void PanelLayer::draw(GLuint framebuffer, int width, int height) {
    if (width <= 0 || height <= 0) return drawTimed();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    timer_.begin(0);
    drawTimed();
    timer_.end();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    timer_.collect([this](uint64_t, const gpu::Timer::Times& times) { uiMs_ = times.ms(); });
}

void PanelLayer::enlarge(float factor) { zoom_ = factor > 0 ? std::clamp(zoom_ * factor, 0.5F, 4.0F) : 1; }

}  // namespace rivulet
