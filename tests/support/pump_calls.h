/* SPDX-License-Identifier: MIT
 *
 * Calls of a pump's client and socket in one line, between lock and unlock.
 */
#ifndef ROBUROC4_TESTS_PUMP_CALLS_H
#define ROBUROC4_TESTS_PUMP_CALLS_H

#include <tuple>
#include <type_traits>

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

/** call(udp, arguments...) of the pump's socket. */
template <class Result, class... Parameters, class... Arguments>
Result on_udp(roburoc4_pump *pump, Result (*call)(const roburoc4_udp *, Parameters...),
              Arguments... arguments) {
    if (roburoc4_pump_lock(pump) == nullptr) {
        return Result{};
    }
    const Result result = std::apply(call, std::tuple<const roburoc4_udp *, Parameters...>(
                                               roburoc4_pump_udp(pump), arguments...));
    roburoc4_pump_unlock(pump);
    return result;
}

} // namespace test

#endif
