/* SPDX-License-Identifier: MIT
 *
 * For its size only: what every program here has.
 */
int main(void) {
    return 0;
}
