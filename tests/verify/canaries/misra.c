/* SPDX-License-Identifier: MIT
 *
 * A deviation from MISRA C:2012 on purpose, of a rule that the core keeps: 15.1, no goto.
 */
int backward(int count);

int backward(int count) {
    int result = 0;
again:
    result++;
    if (result < count) {
        goto again;
    }
    return result;
}
