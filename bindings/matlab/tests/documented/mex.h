/* SPDX-License-Identifier: MIT
 *
 * mex.h - the functions of mex_symbols.txt as MATLAB's documentation declares them, so that a test
 * can compile the MEX file against them where there is no MATLAB. None of them differs between
 * -R2017b and -R2018a. Not used for anything that runs.
 */
#ifndef ROBUROC4_DOCUMENTED_MEX_H
#define ROBUROC4_DOCUMENTED_MEX_H

#include <stdbool.h>
#include <stddef.h>

typedef struct mxArray_tag mxArray;
typedef size_t mwSize;
typedef size_t mwIndex;
typedef bool mxLogical;

typedef enum { mxREAL, mxCOMPLEX } mxComplexity;
typedef enum {
    mxUNKNOWN_CLASS,
    mxCELL_CLASS,
    mxSTRUCT_CLASS,
    mxLOGICAL_CLASS,
    mxCHAR_CLASS,
    mxVOID_CLASS,
    mxDOUBLE_CLASS,
    mxSINGLE_CLASS,
    mxINT8_CLASS,
    mxUINT8_CLASS,
    mxINT16_CLASS,
    mxUINT16_CLASS,
    mxINT32_CLASS,
    mxUINT32_CLASS,
    mxINT64_CLASS,
    mxUINT64_CLASS,
    mxFUNCTION_CLASS
} mxClassID;

void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[]);

int mexAtExit(void (*exit_function)(void));
int mexCallMATLAB(int nlhs, mxArray *plhs[], int nrhs, mxArray *prhs[], const char *function);
void mexLock(void);
void mexUnlock(void);

mxArray *mxCreateCellMatrix(mwSize m, mwSize n);
mxArray *mxCreateDoubleMatrix(mwSize m, mwSize n, mxComplexity complexity);
mxArray *mxCreateDoubleScalar(double value);
mxArray *mxCreateLogicalMatrix(mwSize m, mwSize n);
mxArray *mxCreateLogicalScalar(mxLogical value);
mxArray *mxCreateNumericMatrix(mwSize m, mwSize n, mxClassID type, mxComplexity complexity);
mxArray *mxCreateString(const char *text);
mxArray *mxCreateStructMatrix(mwSize m, mwSize n, int fields, const char **names);

const char *mxGetClassName(const mxArray *array);
void *mxGetData(const mxArray *array);
mxArray *mxGetField(const mxArray *array, mwIndex index, const char *name);
mxArray *mxGetFieldByNumber(const mxArray *array, mwIndex index, int field);
const char *mxGetFieldNameByNumber(const mxArray *array, int field);
double mxGetInf(void);
mxLogical *mxGetLogicals(const mxArray *array);
size_t mxGetM(const mxArray *array);
double mxGetNaN(void);
size_t mxGetNumberOfElements(const mxArray *array);
int mxGetNumberOfFields(const mxArray *array);
double mxGetScalar(const mxArray *array);
int mxGetString(const mxArray *array, char *text, mwSize size);
bool mxIsChar(const mxArray *array);
bool mxIsComplex(const mxArray *array);
bool mxIsLogical(const mxArray *array);
bool mxIsNumeric(const mxArray *array);
bool mxIsSparse(const mxArray *array);
bool mxIsStruct(const mxArray *array);
void mxSetCell(mxArray *array, mwIndex index, mxArray *value);
void mxSetFieldByNumber(mxArray *array, mwIndex index, int field, mxArray *value);

#endif
