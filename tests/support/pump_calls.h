/* SPDX-License-Identifier: MIT
 *
 * Calls of a pump's client, and its socket, in one line, between lock and unlock.
 */
#ifndef ROBUROC4_TESTS_PUMP_CALLS_H
#define ROBUROC4_TESTS_PUMP_CALLS_H

#include <tuple>
#include <type_traits>

#include "counts.h"
#include "roburoc4_pump.h"

namespace test {

/** call(client, arguments...) of the pump's client; where one argument is missing, the time is the
 *  last. In a forked child ROBUROC4_ERR_CLOSED, or 0 where that is no result. */
template <class Result, class Client, class... Parameters, class... Arguments>
Result on_client(roburoc4_pump *pump, Result (*call)(Client *, Parameters...),
                 Arguments... arguments) {
    roburoc4_client *client = roburoc4_pump_lock(pump);
    if (client == nullptr) {
        return static_cast<Result>(std::is_signed_v<Result> ? ROBUROC4_ERR_CLOSED : 0);
    }
    const auto complete = [&] { /* with the types that call() has */
                                if constexpr (sizeof...(Parameters) == sizeof...(Arguments)) {
                                    return std::tuple<Parameters...>(arguments...);
                                } else {
                                    return std::tuple<Parameters...>(arguments...,
                                                                     roburoc4_udp_now_us());
                                }
    };
    const Result result =
        std::apply(call, std::tuple_cat(std::tuple<Client *>(client), complete()));
    roburoc4_pump_unlock(pump);
    return result;
}

/** What the pump's socket shows. */
inline roburoc4_udp socket_of(roburoc4_pump *pump) {
    roburoc4_udp copy{};
    if (roburoc4_pump_lock(pump) != nullptr) {
        copy = *roburoc4_pump_udp(pump);
        roburoc4_pump_unlock(pump);
    }
    return copy;
}

} // namespace test

#endif
