/* What the C tests share: a check that says what did not hold and goes on, and a context. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <string.h>

#include <rivulet/rivulet.h>

static int failures = 0;
static rivulet_error why;

#define CHECK(condition)                                                          \
    do {                                                                          \
        if (!(condition)) {                                                       \
            ++failures;                                                           \
            printf("%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition); \
        }                                                                         \
    } while (0)
/* What must succeed; else its sentence is shown. */
#define DONE(call)                                                             \
    do {                                                                       \
        if ((call) != RIVULET_OK) {                                            \
            ++failures;                                                        \
            printf("%s:%d: %s: %s\n", __FILE__, __LINE__, #call, why.message); \
        }                                                                      \
    } while (0)
/* What must be refused as senseless, in a sentence that holds `words`. */
#define REFUSED(call, words)                                                                                 \
    do {                                                                                                     \
        memset(&why, 0, sizeof why);                                                                         \
        if ((call) != RIVULET_BAD_INPUT || strstr(why.message, words) == NULL) {                             \
            ++failures;                                                                                      \
            printf("%s:%d: not refused with '%s': %s: %s\n", __FILE__, __LINE__, words, #call, why.message); \
        }                                                                                                    \
    } while (0)

static inline rivulet_context* cpu_context(void) {
    rivulet_context* context = NULL;
    rivulet_context_options options;
    memset(&options, 0, sizeof options);
    options.size = sizeof options;
    options.backend = "cpu";
    DONE(rivulet_context_create(&options, &context, &why));
    return context;
}

#endif
