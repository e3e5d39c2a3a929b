// The lab page of loadframe: the job list, a job, and submitting one.
//
// api/     the wire: shapes, requests, events, files, the access token
// format/  numbers, times and names as people read them
// jobs/    the list       job/  one job       submit/  a new one
// ui/      small pieces that several views share
import { mount } from "svelte";
import App from "./App.svelte";
import "./style.css";

const target = document.getElementById("page");
if (target) mount(App, { target });
