#include "runtime/draw/renderer.h"
