#include "engine/gpu/debug.h"

#include <rivulet_glad/gl.h>

#include <string_view>

namespace rivulet::gpu {

struct DebugMessages::State {
    Log log;
    int errors = 0, warnings = 0;
    std::string lastError;

    void take(GLenum source, GLenum type, GLenum severity, std::string_view text) {
        // Program reports compiler messages itself, with the names of the files.
        if (source == GL_DEBUG_SOURCE_SHADER_COMPILER || severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
        const std::string sentence = "OpenGL: " + std::string(text.substr(0, text.find_last_not_of(" \n") + 1));
        if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
            ++errors;
            lastError = sentence;
            log.error(sentence);
        } else if (type == GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR || type == GL_DEBUG_TYPE_PORTABILITY || severity == GL_DEBUG_SEVERITY_HIGH) {
            ++warnings;
            log.warning(sentence);
        } else {
            log.info(sentence);
        }
    }

    static void GLAD_API_PTR callback(GLenum source, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* text,
                                      const void* user) {
        const std::string_view view = length < 0 ? std::string_view(text) : std::string_view(text, static_cast<size_t>(length));
        static_cast<State*>(const_cast<void*>(user))->take(source, type, severity, view);
    }
};

DebugMessages::DebugMessages(Log log) : state_(std::make_unique<State>()) {
    state_->log = std::move(log);
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);  // on this thread, inside the call that causes the message
    glDebugMessageCallback(State::callback, state_.get());
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_TRUE);
}

DebugMessages::DebugMessages(DebugMessages&&) noexcept = default;

DebugMessages& DebugMessages::operator=(DebugMessages&& other) noexcept {
    std::swap(state_, other.state_);
    return *this;
}

DebugMessages::~DebugMessages() {
    if (!state_) return;
    glDebugMessageCallback(nullptr, nullptr);
    glDisable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
}

int DebugMessages::errors() const { return state_->errors; }
int DebugMessages::warnings() const { return state_->warnings; }
const std::string& DebugMessages::lastError() const { return state_->lastError; }

}  // namespace rivulet::gpu
