#include "hierarchy/page.h"
