/* SPDX-License-Identifier: MIT
 *
 * faulty.h - clients with one fault each, made by wrapping the real one: the oracle must catch
 * them.
 */
#ifndef ROBUROC4_SOAK_FAULTY_H
#define ROBUROC4_SOAK_FAULTY_H

#include "client.h"
#include "promises.h"

#include <functional>
#include <memory>
#include <vector>

namespace soak {

struct Fault {
    Promise promise; /* the promise that it breaks */
    const char *what;
    std::function<std::unique_ptr<Client>()> make;
};

const std::vector<Fault> &faults();

} // namespace soak

#endif
