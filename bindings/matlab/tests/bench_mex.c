/* SPDX-License-Identifier: MIT
 *
 * bench_mex(...): a MEX file that does nothing but answer with a row, for bench/matlab.
 */
#include "mex.h"

#ifdef __GNUC__
__attribute__((visibility("default")))
#endif
void mexFunction(int result_count, mxArray *results[], int count, const mxArray *arguments[]) {
    (void)count;
    (void)arguments;
    if (result_count > 0) {
        results[0] = mxCreateDoubleMatrix(1, 3, mxREAL);
    }
}
