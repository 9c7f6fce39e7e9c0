/* A friction switch as a co-simulation unit of FMI 3.0.
 *
 * Input: tension of the motor (N), displacement of the tendon towards the motor (m), wrap angle (rad).
 * Output: tension on the side of the load (N). Between the tensions at which the tendon slides, a bristle of a given
 * stiffness is stretched; beyond them the tendon slides. surface.h has the tensions of the switch. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "surface.h"

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef const char *fmi3String;
/* In FMI 3.0 a Boolean is a C99 bool. */
typedef _Bool fmi3Boolean;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;

enum { TIME, TENSION, DISPLACEMENT, WRAP, OUTPUT, FRICTION, STIFFNESS, DISSIPATED, VARIABLES };

typedef struct {
    double value[VARIABLES];
    double start_time;
    /* Displacement at the last step, and stretch of the bristle (m). */
    double last;
    double stretch;
} Switch;

/* Index of the interval of an ascending table that contains x. */
static size_t interval(const double *table, size_t count, double x) {
    size_t low = 0, high = count - 1;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (table[middle] <= x) low = middle; else high = middle;
    }
    return low;
}

/* Load at which the tendon slides with this tension, from one row of a table. Beyond the table the ratio is constant. */
static double load_of(const double *tension, double x) {
    const size_t last = LOADS - 1;
    if (x <= tension[0]) return x * load_n[0] / tension[0];
    if (x >= tension[last]) return x * load_n[last] / tension[last];
    size_t i = interval(tension, LOADS, x);
    return load_n[i] + (load_n[i + 1] - load_n[i]) * (x - tension[i]) / (tension[i + 1] - tension[i]);
}

/* Load at which the tendon slides, interpolated between wrap angles; without wrap there is no friction. */
static double sliding_load(const double table[WRAPS][LOADS], double tension, double wrap) {
    if (tension <= 0) return 0;
    if (WRAPS == 1) return load_of(table[0], tension);
    if (wrap <= wrap_rad[0]) {
        double share = wrap_rad[0] > 0 && wrap > 0 ? wrap / wrap_rad[0] : 0;
        return tension + share * (load_of(table[0], tension) - tension);
    }
    if (wrap >= wrap_rad[WRAPS - 1]) return load_of(table[WRAPS - 1], tension);
    size_t i = interval(wrap_rad, WRAPS, wrap);
    double share = (wrap - wrap_rad[i]) / (wrap_rad[i + 1] - wrap_rad[i]);
    return (1 - share) * load_of(table[i], tension) + share * load_of(table[i + 1], tension);
}

/* Moves the bristle to the displacement. The friction is that of the new state, so that no energy is returned. */
static void update(Switch *s) {
    double tension = s->value[TENSION] > 0 ? s->value[TENSION] : 0, stiffness = s->value[STIFFNESS];
    double upper = tension - sliding_load(concentric_n, tension, s->value[WRAP]);
    double lower = tension - sliding_load(eccentric_n, tension, s->value[WRAP]);
    double trial = s->stretch + s->value[DISPLACEMENT] - s->last;
    double friction = stiffness * trial;
    if (friction > upper) friction = upper;
    if (friction < lower) friction = lower;
    s->stretch = friction / stiffness;
    /* The rounding of a tendon that sticks is not slip. */
    if (friction != stiffness * trial) s->value[DISSIPATED] += friction * (trial - s->stretch);
    s->last = s->value[DISPLACEMENT];
    s->value[FRICTION] = friction;
    s->value[OUTPUT] = tension - friction;
}

static void reset(Switch *s) {
    memset(s, 0, sizeof *s);
    s->value[WRAP] = wrap_rad[WRAPS - 1];
    s->value[STIFFNESS] = 20000;
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference required[], size_t count, fmi3InstanceEnvironment environment, void *log, void *update_) {
    (void)name; (void)resources; (void)visible; (void)logging; (void)events; (void)early; (void)required; (void)count;
    (void)environment; (void)log; (void)update_;
    if (!token || strcmp(token, TOKEN)) return NULL;
    Switch *s = malloc(sizeof *s);
    if (s) reset(s);
    return s;
}

EXPORT void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
    fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
    (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
    Switch *s = instance;
    s->start_time = s->value[TIME] = start;
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    Switch *s = instance;
    s->last = s->value[DISPLACEMENT];
    update(s);
    return fmi3OK;
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) { (void)instance; return fmi3OK; }
EXPORT fmi3Status fmi3Reset(fmi3Instance instance) { reset(instance); return fmi3OK; }

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count, const fmi3String names[]) {
    (void)instance; (void)on; (void)count; (void)names;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    fmi3Float64 values[], size_t length) {
    if (length < count) return fmi3Error;
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= VARIABLES) return fmi3Error;
        values[i] = ((Switch *)instance)->value[references[i]];
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 values[], size_t length) {
    if (length < count) return fmi3Error;
    for (size_t i = 0; i < count; i++) {
        fmi3ValueReference r = references[i];
        int is_input = r == TENSION || r == DISPLACEMENT || r == WRAP || (r == STIFFNESS && values[i] > 0);
        /* A comparison with NaN is false. */
        if (!is_input || !(values[i] - values[i] == 0)) return fmi3Error;
        ((Switch *)instance)->value[r] = values[i];
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_set,
    fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    (void)no_set;
    Switch *s = instance;
    update(s);
    s->value[TIME] = time + step;
    *event = *terminate = *early = 0;
    *last = time + step;
    return fmi3OK;
}

/* Functions of FMI 3.0 that this unit does not support; each returns an error. */
#define UNSUPPORTED(name) EXPORT fmi3Status name(void) { return fmi3Error; }
#define TYPE(type) UNSUPPORTED(fmi3Get##type) UNSUPPORTED(fmi3Set##type)
TYPE(Float32) TYPE(Int8) TYPE(UInt8) TYPE(Int16) TYPE(UInt16) TYPE(Int32) TYPE(UInt32) TYPE(Int64) TYPE(UInt64)
TYPE(Boolean) TYPE(String) TYPE(Binary) TYPE(Clock) TYPE(FMUState) TYPE(IntervalDecimal) TYPE(IntervalFraction)
TYPE(ShiftDecimal) TYPE(ShiftFraction)
EXPORT void *fmi3InstantiateModelExchange(void) { return NULL; }
EXPORT void *fmi3InstantiateScheduledExecution(void) { return NULL; }
UNSUPPORTED(fmi3EnterEventMode) UNSUPPORTED(fmi3GetNumberOfVariableDependencies)
UNSUPPORTED(fmi3GetVariableDependencies) UNSUPPORTED(fmi3FreeFMUState) UNSUPPORTED(fmi3SerializedFMUStateSize)
UNSUPPORTED(fmi3SerializeFMUState) UNSUPPORTED(fmi3DeserializeFMUState) UNSUPPORTED(fmi3GetDirectionalDerivative)
UNSUPPORTED(fmi3GetAdjointDerivative) UNSUPPORTED(fmi3EnterConfigurationMode) UNSUPPORTED(fmi3ExitConfigurationMode)
UNSUPPORTED(fmi3EvaluateDiscreteStates) UNSUPPORTED(fmi3UpdateDiscreteStates)
UNSUPPORTED(fmi3EnterContinuousTimeMode) UNSUPPORTED(fmi3CompletedIntegratorStep) UNSUPPORTED(fmi3SetTime)
UNSUPPORTED(fmi3SetContinuousStates) UNSUPPORTED(fmi3GetContinuousStateDerivatives)
UNSUPPORTED(fmi3GetEventIndicators) UNSUPPORTED(fmi3GetContinuousStates)
UNSUPPORTED(fmi3GetNominalsOfContinuousStates) UNSUPPORTED(fmi3GetNumberOfEventIndicators)
UNSUPPORTED(fmi3GetNumberOfContinuousStates) UNSUPPORTED(fmi3EnterStepMode) UNSUPPORTED(fmi3GetOutputDerivatives)
UNSUPPORTED(fmi3ActivateModelPartition)
